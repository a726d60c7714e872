"""From a sentence to a folded garment in one call, and where garments come from."""

from polyfold.api._describe import describe
from polyfold.api._fold import attempt, fold
from polyfold.api._loaders import Grounded, garment, ground
from polyfold.api._studies import open, run

__all__ = [
    "Grounded",
    "attempt",
    "describe",
    "fold",
    "garment",
    "ground",
    "open",
    "run",
]
