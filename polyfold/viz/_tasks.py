"""Tasks in pictures: the flat garment, the line of each fold, and how the cloth should lie in the end."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment
from polyfold.geometry import Camera, FoldLine, contour_of
from polyfold.plugins._fabrics import generate_garment
from polyfold.tasks import OpenTask, Task, fold_lines
from polyfold.tasks._ideal import IdealFold, fold_ideally, fold_step_by_step
from polyfold.types import Scene, SimState
from polyfold.viz._draw._cloth import cloth_picture
from polyfold.viz._draw._overlays import overlay
from polyfold.viz._draw._sheets import Card, score_sheet

Image = NDArray[np.uint8]

SIDE = 160
"""Of each picture [px]."""
MOST_ENDS = 4
"""Of a goal's accepted ends, how many are drawn."""
ALIKE = 0.005
"""Pictures that differ in a smaller share of their pixels look the same."""
ROOM = 1.35
"""How much of the table is shown, in garments' lengths."""


def task_sheet(
    tasks: Sequence[Task], goals: Sequence[tuple[OpenTask, Sequence[Task]]] = (), heading: str = ""
) -> Image:
    """A row of pictures for each task: before each fold the cloth with the fold's line, then the end.

    The garments are the first of their kinds, spread upright; they are folded by geometry and not by a simulator.

    Args:
        tasks: which ones; their kinds of garment are installed.
        goals: goals that leave the folds open, each with the tasks whose ends it accepts: those that look different
            are drawn, or the flat garment if it accepts none.
        heading: what stands above all.

    Returns:
        uint8, shape (H, W, 3).

    Raises:
        ConfigError: if there is nothing to draw.
        PluginError: if no plugin provides a kind of garment.
    """
    cards = [Card((*_folds(task), _end(task)), task.id, "".join(task.instructions[:1])) for task in tasks]
    cards += [Card(_ends(goal, accepted), goal.id, goal.text) for goal, accepted in goals]
    return score_sheet(cards, heading, side=SIDE)


def _folds(task: Task) -> list[Image]:
    """The cloth before each fold, with what is lifted."""
    garment, flat, lines = _laid_out(task)
    states = [fold_ideally(flat, garment, ()), *fold_step_by_step(flat, garment, lines[:-1])]
    return [_before(garment, flat, state, line) for state, line in zip(states, lines, strict=True)]


def _end(task: Task) -> Image:
    garment, flat, lines = _laid_out(task)
    return _drawn(garment, flat, fold_ideally(flat, garment, lines))


def _ends(goal: OpenTask, accepted: Sequence[Task]) -> list[Image]:
    """Accepted ends that look different, the first few of them."""
    if not accepted:
        garment = _spread(goal.garment)
        flat = _flat(garment)
        return [_drawn(garment, flat, fold_ideally(flat, garment, ()))]
    found: list[Image] = []
    for end in map(_end, accepted):
        if len(found) < MOST_ENDS and all(_differing(end, other) > ALIKE for other in found):
            found.append(end)
    return found


def _differing(one: Image, other: Image) -> float:
    """Share of the pixels that differ to the eye."""
    return float((np.abs(one.astype(int) - other).max(axis=2) > 30).mean())


def _laid_out(task: Task) -> tuple[Garment, SimState, list[FoldLine]]:
    garment = _spread(task.garment)
    flat = _flat(garment)
    return garment, flat, fold_lines(task, flat.keypoint_pixels())


@cache
def _spread(kind: str) -> Garment:
    return generate_garment(kind, 0)


def _flat(garment: Garment) -> SimState:
    """The garment upright in the middle of a picture that leaves some table around it."""
    flat = garment.mesh.vertices
    low, high = flat.min(0), flat.max(0)
    positions = np.column_stack([flat - (low + high) / 2, np.zeros(len(flat))])
    camera = Camera.framing(ROOM * float((high - low).max()))
    return SimState(positions, np.zeros_like(positions), garment.keypoints, camera)


def _before(garment: Garment, flat: SimState, state: IdealFold, line: FoldLine) -> Image:
    """The cloth with what the next fold lifts."""
    size = state.mask.shape[1], state.mask.shape[0]
    scene = Scene(garment.kind, size, state.mask, contour_of(state.mask), None, "")
    blank = np.zeros((*state.mask.shape, 3), np.uint8)
    return overlay(blank, scene, line, zoom=SIDE / size[0], shown=_drawn(garment, flat, state))


def _drawn(garment: Garment, flat: SimState, state: IdealFold) -> Image:
    return cloth_picture(state.outcome(flat, garment.mesh).end, garment, SIDE / flat.camera.width)
