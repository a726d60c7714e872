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

_PUBLIC = {
    "Action": "polyfold.types",
    "Camera": "polyfold.types",
    "Decision": "polyfold.types",
    "Episode": "polyfold.episode",
    "Experiment": "polyfold.config",
    "FoldLine": "polyfold.types",
    "FoldedModel": "polyfold.polygon",
    "Garment": "polyfold.garments",
    "Observation": "polyfold.types",
    "PolyfoldError": "polyfold.errors",
    "RefusedError": "polyfold.errors",
    "Scene": "polyfold.types",
    "Subgoal": "polyfold.types",
    "Template": "polyfold.polygon",
    "Study": "polyfold.study",
    "ablate": "polyfold.study",
    "compare": "polyfold.results",
    "fold": "polyfold.folding",
    "garment": "polyfold.sources",
    "grid": "polyfold.study",
    "ground": "polyfold.sources",
    "hookimpl": "polyfold.hookspecs",
    "load": "polyfold.study",
    "register": "polyfold.plugins",
    "run": "polyfold.results",
    "table": "polyfold.results",
}

__all__ = [
    "Action",
    "Camera",
    "Decision",
    "Episode",
    "Experiment",
    "FoldLine",
    "FoldedModel",
    "Garment",
    "Observation",
    "PolyfoldError",
    "RefusedError",
    "Scene",
    "Study",
    "Subgoal",
    "Template",
    "__version__",
    "ablate",
    "compare",
    "fold",
    "garment",
    "grid",
    "ground",
    "hookimpl",
    "load",
    "plugins",
    "register",
    "run",
    "table",
]

if TYPE_CHECKING:
    from polyfold import plugins
    from polyfold.config import Experiment
    from polyfold.episode import Episode
    from polyfold.errors import PolyfoldError, RefusedError
    from polyfold.folding import fold
    from polyfold.garments import Garment
    from polyfold.hookspecs import hookimpl
    from polyfold.plugins import register
    from polyfold.polygon import FoldedModel, Template
    from polyfold.results import compare, run, table
    from polyfold.sources import garment, ground
    from polyfold.study import Study, ablate, grid, load
    from polyfold.types import Action, Camera, Decision, FoldLine, Observation, Scene, Subgoal


def __getattr__(name: str) -> Any:
    if name == "plugins":
        return import_module("polyfold.plugins")
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'polyfold' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
