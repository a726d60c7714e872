"""Studies: a grid of variants over tasks and garments, run anywhere, resumed after any kill."""

from polyfold.studies._cell import PICTURES, evaluate_cell
from polyfold.studies._cells import Cell, cells
from polyfold.studies._executors import in_processes
from polyfold.studies._run import evaluate
from polyfold.studies._study import Study, ablate, experiment_of, grid, load, with_variants

__all__ = [
    "PICTURES",
    "Cell",
    "Study",
    "ablate",
    "cells",
    "evaluate",
    "evaluate_cell",
    "experiment_of",
    "grid",
    "in_processes",
    "load",
    "with_variants",
]
