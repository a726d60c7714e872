"""Fold lines through a fitted garment's vertices, against the same lines through its true keypoints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.fitting.simulated import fitted_garments
from polyfold import plugins
from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Grounding
from polyfold.tasks import Task, fold_lines, load_suite

Floats = NDArray[np.float64]

ROTATION = 20.0
"""Garments are turned by up to this angle [deg], as in the studies."""


@dataclass(frozen=True, eq=False)
class CreaseResult:
    """One task's fold line on one garment.

    Attributes:
        task: the task's id.
        turn: how far the fit's line is turned from the true one [deg], without sign.
        blame: vertex -> the same if only that vertex is the fit's and the other end is true [deg].
    """

    task: str
    turn: float
    blame: Mapping[str, float]


def measure_creases(kind: str, seeds: Iterable[int], grounding: Grounding) -> list[CreaseResult]:
    """Draw the lines of all tasks of one fold whose crease runs through two vertices (a t-shirt's sleeves)."""
    suite = load_suite(str(plugins.find("tasks", "polyfold70").target))
    tasks = [task for task in suite.for_garment(kind) if _ends(task)]
    return [
        _compared(task, found, truth)
        for found, truth in fitted_garments(kind, seeds, grounding, ROTATION)
        for task in tasks
    ]


def _ends(task: Task) -> list[str]:
    """The vertices at the ends of a task's only crease; none where it has more folds, or ends between vertices."""
    creases = [step.crease for step in task.steps]
    if len(creases) != 1 or creases[0] is None or any(len(end) != 1 for end in creases[0]):
        return []
    return [name for end in creases[0] for name in end]


def _compared(task: Task, found: Mapping[str, Floats], truth: Mapping[str, Floats]) -> CreaseResult:
    true_line = fold_lines(task, truth)[0]
    blame = {name: _turn(fold_lines(task, {**truth, name: found[name]})[0], true_line) for name in _ends(task)}
    return CreaseResult(task.id, _turn(fold_lines(task, found)[0], true_line), blame)


def _turn(line: FoldLine, other: FoldLine) -> float:
    (x, y), (u, v) = np.subtract(line.end, line.start), np.subtract(other.end, other.start)
    return float(abs(np.degrees(np.arctan2(x * v - y * u, x * u + y * v))))
