"""What is loaded, and when: a light import and a light help, heavy packages only with the component that needs them."""

import subprocess
import sys

import pytest

HEAVY = (
    "torch", "numba", "pybullet", "litellm", "cv2", "matplotlib", "scipy", "shapely", "jupyterlab", "trimesh", "pandas",
    "gymnasium", "pyarrow", "av", "anywidget", "cloudpickle",
)  # fmt: skip


@pytest.mark.parametrize(
    "code",
    [
        "import polyfold",
        "import polyfold; polyfold.Experiment; polyfold.FoldLine; polyfold.hookimpl",
        "from polyfold.cli import main\ntry: main(['--no-plugins', '--help'])\nexcept SystemExit: pass",
        "from polyfold.cli import main; main(['--no-plugins', 'plugins'])",
    ],
)
def test_light_paths_load_nothing_heavy(code):
    check = f"{code}\nimport sys\nloaded = [m for m in {HEAVY} if m in sys.modules]\nassert not loaded, loaded"
    result = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 0, result.stderr


def test_reading_parameters_of_components_loads_nothing_heavy():
    # What needs a package that is not installed has parameters all the same.
    code = (
        "from importlib import import_module\n"
        "from polyfold import plugins; plugins.refresh(third_party=False)\n"
        "for kind in ('simulators cameras robots segmenters groundings planners policies llms agents garments '\n"
        "             'fabrics').split():\n"
        "    for name in plugins.names(kind):\n"
        "        target = plugins.catalog().components[kind][name][-1].target\n"
        "        module, _, cls = target.partition(':')\n"
        "        getattr(getattr(import_module(module), cls), 'Config', None)\n"
    )
    test_light_paths_load_nothing_heavy(code)


def test_public_names_resolve():
    import polyfold

    assert len(polyfold.__all__) <= 30
    for name in polyfold.__all__:
        assert getattr(polyfold, name) is not None
