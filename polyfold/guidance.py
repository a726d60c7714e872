"""What agents may be told beyond the sentence: accurate subgoals, goal pictures and fold lines, made from a task.

Baselines that can't decompose a sentence are given ``steps`` guidance; with ``final`` guidance they get the goal alone
(paper, Tables II and III). Everything here comes from the true keypoints; PolyFold itself asks for none of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment
from polyfold.ideal import fold_ideally
from polyfold.tasks import Fold, Task, fold_lines
from polyfold.types import FoldLine, Observation, SimState

__all__ = ["Guidance", "describe", "guidance_for"]

Image = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Guidance:
    """Accurate help for one garment as it lies.

    Attributes:
        fold_lines: the ideal fold lines [px], one per step.
        subgoal_texts: each step in words.
        subgoal_images: what the garment should look like after each step, uint8, shape (H, W, 3).
    """

    fold_lines: tuple[FoldLine, ...]
    subgoal_texts: tuple[str, ...]
    subgoal_images: tuple[Image, ...]

    @property
    def goal_image(self) -> Image:
        """What the garment should look like in the end."""
        return self.subgoal_images[-1]


def guidance_for(task: Task, garment: Garment, flat: SimState, seen: Observation) -> Guidance:
    """Make the guidance for a task on a garment that lies flat.

    Args:
        task: the task; its kind must be the garment's.
        garment: the garment.
        flat: the state before the first fold.
        seen: the picture of that state; its first pixel gives the table's colour.
    """
    lines = fold_lines(task, flat.keypoint_pixels())
    masks = (fold_ideally(flat, garment.mesh, lines[: count + 1]).mask for count in range(len(lines)))
    images = tuple(_drawn(mask, garment.colours[0], seen.rgb[0, 0]) for mask in masks)
    return Guidance(tuple(lines), tuple(describe(fold) for fold in task.steps), images)


def _drawn(mask: NDArray[np.bool_], cloth: tuple[int, int, int], table: Image) -> Image:
    picture = np.empty((*mask.shape, 3), np.uint8)
    picture[:] = table
    picture[mask] = cloth
    return picture


def describe(fold: Fold) -> str:
    """A task's step in words, by the names of its points."""
    if fold.pairs is not None:
        moves = [f"{_named(source)} onto {_named(target)}" for source, target in fold.pairs]
        return f"fold {' and '.join(moves)}"
    assert fold.crease is not None
    assert fold.lift is not None
    start, end = fold.crease
    return f"fold {_named(fold.lift)} over along the line from {_named(start)} to {_named(end)}"


def _named(point: Mapping[str, float]) -> str:
    """``top left``, or ``the point between top left and top right`` with the weights where they differ."""
    names = [name.replace("_", " ") for name in point]
    if len(names) == 1:
        return names[0]
    shares = list(point.values())
    if max(shares) - min(shares) < 0.01:
        return f"the middle of {' and '.join(names)}"
    parts = [f"{share:.0%} {name}" for name, share in zip(names, shares, strict=True)]
    return f"the point {' and '.join(parts)}"
