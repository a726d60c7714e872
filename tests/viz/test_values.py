"""What a notebook cell ends with shows itself as a picture."""

import subprocess
import sys
from importlib import import_module

import numpy as np
import pytest

from polyfold import plugins
from polyfold._jupyter import SHOWN
from polyfold.types import Action, Observation
from polyfold.viz._values import picture_of

PROGRAM = """
import sys
from IPython.core.interactiveshell import InteractiveShell
shown = InteractiveShell.instance().display_formatter.formatters["image/png"]
import polyfold
assert "polyfold.viz" not in sys.modules, "nothing is imported before it is shown"
print(shown(polyfold.FoldLine((10, 10), (90, 90)))[:8] == b"\\x89PNG\\r\\n\\x1a\\n", shown([1]) is None)
"""


@pytest.mark.parametrize(("module", "name"), SHOWN)
def test_what_is_registered_by_name_is_there(module, name):
    found = getattr(import_module(module), name)
    assert (found.__module__, found.__qualname__) == (module, name)
    assert picture_of.dispatch(found) is not picture_of.dispatch(object)


def test_ipython_shows_them_once_polyfold_is_imported():
    told = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert told.stdout.split() == ["True", "True"], told.stderr


def test_each_is_a_picture_of_itself(rgb, scene, fold_line, action):
    garment, other = (plugins.generate_garment(kind, 0, 0.03) for kind in ("tshirt", "square"))
    depth = np.full(rgb.shape[:2], 2.0, np.float32)
    depth[0, 0], depth[scene.mask] = np.nan, 1.99
    seen = Observation(rgb, depth, plugins.create("simulators", "xpbd").reset(other, 0).camera)
    pictures = [picture_of(v) for v in (garment, other, garment, scene, scene.model, fold_line, action, seen)]
    for picture in pictures:
        assert picture.dtype == np.uint8
        assert picture.ndim == 3
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 3
    assert (pictures[0].shape, pictures[0].tobytes()) == (pictures[2].shape, pictures[2].tobytes())
    template = picture_of(plugins.create("garments", "tshirt").template())
    assert template.shape[1] > template.shape[0], "the names stand on both sides"


def test_far_away_pixels_make_the_picture_larger():
    assert picture_of(Action(np.array([[900.0, 10.0]]), np.array([[10.0, 700.0]]))).shape == (740, 940, 3)


def test_what_is_no_picture_is_refused():
    with pytest.raises(TypeError, match="a dict is no picture"):
        picture_of({})
