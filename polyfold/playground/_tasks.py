"""What was folded by hand as a task: each line told by the keypoints of the flat garment, so that it fits others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from polyfold.errors import ConfigError, validation_problem
from polyfold.garments import Garment
from polyfold.geometry import FoldLine
from polyfold.tasks import Suite, Task
from polyfold.tasks._lines import points_after
from polyfold.tasks._suite import Fold
from polyfold.types import Step

Floats = NDArray[np.float64]
Points = Mapping[str, Floats]

SURE = 0.3
"""Points of a line that are at least this share of the span apart tell its direction."""

NEAR = 0.025
"""A point that comes to lie this near another, as a share of the garment's span, was meant to."""


def as_task(garment: Garment, keypoints: Points, moves: Sequence[tuple[str | None, Sequence[Step]]], name: str) -> str:
    """A suite of one task, in TOML.

    Args:
        garment: what was folded.
        keypoints: keypoint name -> pixel of the flat garment, shape (2,).
        moves: each sentence, or None for a move by hand, with the folds that it made.
        name: the task's id.

    Raises:
        ConfigError: if the name serves no task, a fold has no line, or none took hold of the cloth.
    """
    import tomli_w

    task, said = told(garment, keypoints, moves, name)
    if task is None:
        raise ConfigError("no fold took hold of the cloth, so there is no task; fold something first")
    asked = task.model_copy(update={"instructions": (said,)}).model_dump(mode="json", exclude_none=True)
    asked["steps"] = [_short(step) for step in asked["steps"]]
    suite = {"schema_version": 1, "name": name, "unseen_wordings": [], "task": [asked]}
    Suite.model_validate(suite)
    return tomli_w.dumps(suite)


def told(
    garment: Garment, keypoints: Points, moves: Sequence[tuple[str | None, Sequence[Step]]], name: str = "by-hand"
) -> tuple[Task | None, str]:
    """The moves as a task, None if none took hold of the cloth, and all of them in words."""
    task, words = None, []
    for sentence, steps in moves:
        for step in steps:
            if step.retry or not _took_hold(step):
                continue
            if step.fold_line is None:
                raise ConfigError(f"fold {step.index + 1} has no line that a task could tell; undo it")
            task = _with(task, garment, keypoints, step.fold_line, name)
            words += [] if sentence else [task.steps[-1].in_words()]
        words += [sentence] if sentence else []
    return task, "; then ".join(words)


def _took_hold(step: Step) -> bool:
    """Whether any arm held cloth, as far as the simulator says."""
    return step.after.grasped is None or max(step.after.grasped, default=0) > 0


def _with(task: Task | None, garment: Garment, keypoints: Points, line: FoldLine, name: str) -> Task:
    """The task with one more fold."""
    at = points_after(task, keypoints)
    folds = () if task is None else task.steps
    try:
        return Task(id=name, garment=garment.kind, type="custom", steps=(*folds, fold_along(line, at, garment)))
    except ValidationError as error:
        raise ConfigError(f"the task {validation_problem(error, Task.model_fields)}") from error


def fold_along(line: FoldLine, at: Points, garment: Garment) -> Fold:
    """A step whose line is this one.

    Where it brings every lifted keypoint onto another one, that is what it is for; else it is where it crosses the
    polygon of the keypoints.

    Args:
        line: the fold line [px].
        at: keypoint name -> pixel, shape (2,).
        garment: tells in which order the keypoints lie around it.
    """
    span = float(np.ptp(np.array(list(at.values())), axis=0).max())
    lifted = [name for name, point in at.items() if line.distance(point) > NEAR * span]
    pairs = [(name, partner) for name in lifted if (partner := _partner(line, name, at, NEAR * span))]
    if pairs and len(pairs) == len(lifted):
        return Fold.model_validate({"pairs": pairs})
    lift = max(lifted, key=lambda name: float(line.distance(at[name])), default=None)
    crease = _crossings(line, at, _around(garment), SURE * span)
    if lift is None or crease is None:
        crease = tuple(_weights(point, at) for point in (line.start, line.end))
        lift = lift or _weights(line.shifted(0.1 * span).start, at)
    return Fold.model_validate({"crease": crease, "lift": lift})


def _partner(line: FoldLine, name: str, at: Points, near: float) -> str | None:
    """The keypoint that one comes to lie on."""
    landed = line.mirror(at[name])
    away = {other: float(np.hypot(*(landed - point))) for other, point in at.items() if other != name}
    closest = min(away, key=away.__getitem__)
    return closest if away[closest] <= near and line.distance(at[closest]) <= 0 else None


def _around(garment: Garment) -> list[str]:
    """The keypoints in the order in which they lie around the garment."""
    place = {int(vertex): index for index, vertex in enumerate(garment.mesh.boundary)}
    return sorted(garment.keypoints, key=lambda name: place.get(garment.keypoints[name], 0))


def _crossings(
    line: FoldLine, at: Points, order: Sequence[str], least: float
) -> tuple[dict[str, float], dict[str, float]] | None:
    """The outermost points where a line crosses the polygon, as shares of the two keypoints beside each.

    None where they are nearer than ``least`` [px]: too near to tell the line.
    """
    along = np.subtract(line.end, line.start) / line.length
    found: list[tuple[float, dict[str, float]]] = []
    for one, other in pairwise([*order, order[0]]):
        here, there = float(line.distance(at[one])), float(line.distance(at[other]))
        if (here > 0) == (there > 0):
            continue
        share = round(here / (here - there), 4)
        point = (1 - share) * at[one] + share * at[other]
        weights = {one: round(1 - share, 4), other: share}
        found.append((float((point - line.start) @ along), {name: w for name, w in weights.items() if w}))
    found.sort(key=lambda crossing: crossing[0])
    if len(found) < 2 or found[-1][0] - found[0][0] < least:
        return None
    return found[0][1], found[-1][1]


def _weights(point: Any, at: Points) -> dict[str, float]:
    """The smallest weights that sum to 1 and give a point, by all keypoints."""
    names = list(at)
    system = np.vstack([np.array([at[name] for name in names]).T, np.ones(len(names))])
    weights = np.linalg.lstsq(system, np.array([*point, 1.0]), rcond=None)[0]
    return {name: float(weight) for name, weight in zip(names, weights.round(6), strict=True)}


def _short(step: Mapping[str, Any]) -> dict[str, Any]:
    """A step with bare names where a point is a keypoint."""

    def shortened(value: Any) -> Any:
        if isinstance(value, Mapping):
            return next(iter(value)) if len(value) == 1 else value
        return [shortened(item) for item in value]

    return {key: shortened(value) for key, value in step.items()}
