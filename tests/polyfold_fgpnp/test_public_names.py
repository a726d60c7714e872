"""What notebooks and scripts import from the package itself."""

import subprocess
import sys

import polyfold_fgpnp
import pytest


def test_every_public_name_is_there():
    for name in polyfold_fgpnp.__all__:
        assert getattr(polyfold_fgpnp, name) is not None
    assert set(polyfold_fgpnp.__all__) <= set(dir(polyfold_fgpnp))
    with pytest.raises(AttributeError, match="colect"):
        _ = polyfold_fgpnp.colect


def test_the_package_is_light_until_a_name_is_used():
    program = "import sys, polyfold_fgpnp.hooks; print({'torch', 'numba', 'cv2', 'numpy'} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
