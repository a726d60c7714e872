"""Pictures of goals, one after the other, through the window about the garment."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.plugins.interfaces import Goal
from polyfold.types import Observation
from polyfold_baselines.demos.demonstrating import LOWEST
from polyfold_baselines.demos.window import Window

View = tuple[NDArray[np.float32], NDArray[np.bool_]]
"""Heights above the table [m] and where cloth is, shape (SIDE, SIDE) each."""


class GoalPictures:
    """What an episode's goals look like from where the garment lies.

    With steps guidance there is one for each fold; the final goal alone is that of every fold that the task takes.

    Args:
        goal: with ``subgoal_depths`` and ``fold_count``.
        observation: of the flat garment.
        mask: where that is, bool, shape (H, W).

    Attributes:
        window: through which everything is seen.
        final: whether they are the final goal alone.
    """

    def __init__(self, goal: Goal, observation: Observation, mask: NDArray[np.bool_]) -> None:
        self.window = Window.around(mask)
        wanted = [observation.camera.elevation - depth for depth in goal.subgoal_depths or ()]
        self._views = [(self.window.view(heights), self.window.view(heights > LOWEST) > 0.5) for heights in wanted]
        self._folds = goal.fold_count or len(self._views)
        self._step = 0
        self.final = len(self._views) < self._folds

    def next(self) -> View | None:
        """What the next fold should lead to; None after the last."""
        if self._step == self._folds:
            return None
        self._step += 1
        return self._views[min(self._step, len(self._views)) - 1]

    def now(self, observation: Observation, mask: NDArray[np.bool_]) -> View:
        """What the cloth looks like, masked bool, shape (H, W)."""
        heights = np.nan_to_num(observation.camera.elevation - observation.depth)
        return self.window.view(heights), self.window.view(mask) > 0.5
