"""Folds for other people's tools: an environment for Gymnasium, data sets for LeRobot.

Public names are loaded when first used: what they need is not installed everywhere.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOMES = {"FoldingEnv": "polyfold_interchange.environment", "write_dataset": "polyfold_interchange.lerobot"}

__all__ = ["FoldingEnv", "write_dataset"]

if TYPE_CHECKING:
    from polyfold_interchange.environment import FoldingEnv
    from polyfold_interchange.lerobot import write_dataset


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'polyfold_interchange' has no attribute {name!r}")
