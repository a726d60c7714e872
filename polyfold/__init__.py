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
    "fold": "polyfold.folding",
    "garment": "polyfold.sources",
    "ground": "polyfold.sources",
    "hookimpl": "polyfold.hookspecs",
    "register": "polyfold.plugins",
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
    "Subgoal",
    "Template",
    "__version__",
    "fold",
    "garment",
    "ground",
    "hookimpl",
    "plugins",
    "register",
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
    from polyfold.sources import garment, ground
    from polyfold.types import Action, Camera, Decision, FoldLine, Observation, Scene, Subgoal


def __getattr__(name: str) -> Any:
    if name == "plugins":
        return import_module("polyfold.plugins")
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'polyfold' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
