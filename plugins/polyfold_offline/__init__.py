"""The backend ``offline``: reads fold language with a small network, and reasons exactly about cloth.

A sentence passes through the packages in this order, each of which imports only those before it:

    cloth     the garment that messages describe: parts, fold lines, picks and places
    meaning   programs of steps and goals, and the folds that these are on a garment
    reading   sentence to program by a network in numpy, with how sure it is
    backend   messages in, answers out
    training  written sentences to weights, in torch

Its class is loaded when first used, so that importing the package stays light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__all__ = ["OfflineLLM"]

if TYPE_CHECKING:
    from polyfold_offline.backend import OfflineLLM


def __getattr__(name: str) -> Any:
    if name in __all__:
        from polyfold_offline import backend

        return getattr(backend, name)
    raise AttributeError(f"module 'polyfold_offline' has no attribute {name!r}")
