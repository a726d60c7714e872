"""PolyFold: fold cloth with two robot arms from a sentence.

    >>> import polyfold
    >>> episode = polyfold.fold("fold the t-shirt into a rectangular block", garment="tshirt", seed=0)
    >>> episode.fidelity.iou

Public names are loaded when first used, so that ``import polyfold`` stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "polyfold.analysis": ("compare", "table"),
    "polyfold.api": ("describe", "fold", "garment", "ground", "open", "run"),
    "polyfold.config": ("Experiment",),
    "polyfold.errors": ("PolyfoldError", "RefusedError"),
    "polyfold.garments": ("Fabric", "Garment"),
    "polyfold.geometry": ("Camera", "FoldLine"),
    "polyfold.playground": ("play",),
    "polyfold.plugins": ("register",),
    "polyfold.plugins.hookspecs": ("hookimpl",),
    "polyfold.studies": ("Study", "ablate", "grid", "load"),
    "polyfold.types": ("Action", "Decision", "Episode", "Observation", "Scene", "Subgoal"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}
_MODULES = {"plugins": "polyfold.plugins", "view": "polyfold.viz"}

__all__ = [
    "Action",
    "Camera",
    "Decision",
    "Episode",
    "Experiment",
    "Fabric",
    "FoldLine",
    "Garment",
    "Observation",
    "PolyfoldError",
    "RefusedError",
    "Scene",
    "Study",
    "Subgoal",
    "__version__",
    "ablate",
    "compare",
    "describe",
    "fold",
    "garment",
    "grid",
    "ground",
    "hookimpl",
    "load",
    "open",
    "play",
    "plugins",
    "register",
    "run",
    "table",
]

if TYPE_CHECKING:
    from polyfold import plugins
    from polyfold.analysis import compare, table
    from polyfold.api import describe, fold, garment, ground, open, run
    from polyfold.config import Experiment
    from polyfold.errors import PolyfoldError, RefusedError
    from polyfold.garments import Fabric, Garment
    from polyfold.geometry import Camera, FoldLine
    from polyfold.playground import play
    from polyfold.plugins import register
    from polyfold.plugins.hookspecs import hookimpl
    from polyfold.studies import Study, ablate, grid, load
    from polyfold.types import Action, Decision, Episode, Observation, Scene, Subgoal


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(_MODULES[name])
    if name in _HOME_OF:
        return getattr(import_module(_HOME_OF[name]), name)
    raise AttributeError(f"module 'polyfold' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _show_values_in_jupyter() -> None:
    from polyfold._jupyter import register

    register()


_show_values_in_jupyter()
