"""Folding tasks as data: suites, goals that leave the folds open, fold lines on a garment, the ideal result."""

from polyfold.tasks._goals import OpenTask
from polyfold.tasks._lines import fold_lines, mirror_line
from polyfold.tasks._suite import Suite, Task, load_suite

__all__ = [
    "OpenTask",
    "Suite",
    "Task",
    "fold_lines",
    "load_suite",
    "mirror_line",
]
