"""Folding tasks as data: suites, goals that leave the folds open, fold lines on a garment, the ideal result."""

from polyfold.tasks._goals import Bounds, Measured, OpenTask, measure
from polyfold.tasks._ideal import IdealFold, fidelity, fold_ideally
from polyfold.tasks._lines import fold_lines, mirror_line, recognise
from polyfold.tasks._suite import Fold, Suite, Task, load_suite
from polyfold.tasks._words import describe

__all__ = [
    "Bounds",
    "Fold",
    "IdealFold",
    "Measured",
    "OpenTask",
    "Suite",
    "Task",
    "describe",
    "fidelity",
    "fold_ideally",
    "fold_lines",
    "load_suite",
    "measure",
    "mirror_line",
    "recognise",
]
