"""Fold-line-guided pick-and-place: policies, the data they learn from, their training, and studies of the result.

    >>> from polyfold_fgpnp import Interaction, collect, train
    >>> collect(Interaction(garment_kind="tshirt"), folds=10_000, out="runs/folds")

Each of ``policies``, ``data``, ``training`` and ``studies`` imports only those before it. Public names are loaded when
first used: those of training bring PyTorch.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOMES = {
    "polyfold_fgpnp.data.collect": ("collect",),
    "polyfold_fgpnp.data.dataset": ("Dataset", "load_dataset"),
    "polyfold_fgpnp.data.describe": ("describe", "pick_sheet"),
    "polyfold_fgpnp.data.interaction": ("Interaction",),
    "polyfold_fgpnp.training.config": ("TrainingConfig",),
    "polyfold_fgpnp.training.training": ("train",),
    "polyfold_fgpnp.studies.maps": ("FOUR_TASKS", "action_map_sheet"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "FOUR_TASKS",
    "Dataset",
    "Interaction",
    "TrainingConfig",
    "action_map_sheet",
    "collect",
    "describe",
    "load_dataset",
    "pick_sheet",
    "train",
]

if TYPE_CHECKING:
    from polyfold_fgpnp.data.collect import collect
    from polyfold_fgpnp.data.dataset import Dataset, load_dataset
    from polyfold_fgpnp.data.describe import describe, pick_sheet
    from polyfold_fgpnp.data.interaction import Interaction
    from polyfold_fgpnp.studies.maps import FOUR_TASKS, action_map_sheet
    from polyfold_fgpnp.training.config import TrainingConfig
    from polyfold_fgpnp.training.training import train


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
