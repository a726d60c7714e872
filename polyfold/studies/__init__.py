"""Studies: a grid of variants over tasks and garments, run anywhere, resumed after any kill."""

from polyfold.studies import _telling as _telling
from polyfold.studies._executors import in_processes
from polyfold.studies._study import Study, ablate, grid, load

__all__ = [
    "Study",
    "ablate",
    "grid",
    "in_processes",
    "load",
]
