"""What agents may be told beyond the sentence: accurate subgoals, goal pictures and fold lines, made from a task.

Baselines that can't decompose a sentence are given ``steps`` guidance; with ``final`` guidance they get the goal alone
(paper, Tables II and III). Everything here comes from the true keypoints; PolyFold itself asks for none of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment
from polyfold.geometry import FoldLine
from polyfold.tasks import Task, fold_lines
from polyfold.tasks._ideal import fold_step_by_step
from polyfold.types import Observation, Outcome, SimState

Image = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class PrivilegedInputs:
    """Accurate help for one garment as it lies.

    Attributes:
        fold_lines: the ideal fold lines [px], one per step.
        subgoal_texts: each step in words.
        subgoal_images: what the garment should look like after each step, uint8, shape (H, W, 3).
        subgoal_depths: what depth should be measured after each step [m], float32, shape (H, W).
        ideals: the flat garment and what it should be after each step.
    """

    fold_lines: tuple[FoldLine, ...]
    subgoal_texts: tuple[str, ...]
    subgoal_images: tuple[Image, ...]
    subgoal_depths: tuple[NDArray[np.float32], ...]
    ideals: tuple[Outcome, ...]

    @property
    def goal_image(self) -> Image:
        """What the garment should look like in the end."""
        return self.subgoal_images[-1]


def privileged_inputs(task: Task, garment: Garment, flat: SimState, seen: Observation) -> PrivilegedInputs:
    """Make them for a task on a garment that lies flat.

    Args:
        task: the task; its kind must be the garment's.
        garment: the garment.
        flat: the state before the first fold.
        seen: the picture of that state; its first pixel gives the table's colour.
    """
    lines = fold_lines(task, flat.keypoint_pixels())
    folded = fold_step_by_step(flat, garment, lines)
    images = tuple(_drawn(ideal.mask, garment.colours[0], seen.rgb[0, 0]) for ideal in folded)
    ideals = tuple(ideal.outcome(flat, garment.mesh) for ideal in folded)
    texts, depths = tuple(fold.in_words() for fold in task.steps), tuple(ideal.depth for ideal in folded)
    return PrivilegedInputs(tuple(lines), texts, images, depths, ideals)


def _drawn(mask: NDArray[np.bool_], cloth: tuple[int, int, int], table: Image) -> Image:
    picture = np.empty((*mask.shape, 3), np.uint8)
    picture[:] = table
    picture[mask] = cloth
    return picture
