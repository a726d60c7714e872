"""What an episode's folds should lead to, one after the other: pictures through the window, or sentences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from polyfold.plugins.interfaces import Goal
from polyfold.types import Observation
from polyfold_baselines.demos.demonstrating import LOWEST
from polyfold_baselines.demos.window import Window

View = tuple[NDArray[np.float32], NDArray[np.bool_]]
"""Heights above the table [m] and where cloth is, shape (SIDE, SIDE) each."""


Wanted = TypeVar("Wanted")


class InTurn(Generic[Wanted]):
    """What each fold should lead to; what is told last holds for all further ones.

    Args:
        wanted: as told, at least one.
        folds: how many the task takes; as many as are told if nobody says.

    Attributes:
        final: whether less was told than there are folds: the final goal alone.
    """

    def __init__(self, wanted: Sequence[Wanted], folds: int | None) -> None:
        self._wanted, self._folds, self._step = wanted, folds or len(wanted), 0
        self.final = len(wanted) < self._folds

    def next(self) -> Wanted | None:
        """That of the next fold; None after the last."""
        if self._step == self._folds:
            return None
        self._step += 1
        return self._wanted[min(self._step, len(self._wanted)) - 1]


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
        views = [(self.window.view(heights), self.window.view(heights > LOWEST) > 0.5) for heights in wanted]
        self._views = InTurn(views, goal.fold_count)
        self.final = self._views.final

    def next(self) -> View | None:
        """What the next fold should lead to; None after the last."""
        return self._views.next()

    def now(self, observation: Observation, mask: NDArray[np.bool_]) -> View:
        """What the cloth looks like, masked bool, shape (H, W)."""
        return seen_through(self.window, observation, mask)


def seen_through(window: Window, observation: Observation, mask: NDArray[np.bool_]) -> View:
    """What the cloth, masked bool, shape (H, W), looks like."""
    heights = np.nan_to_num(observation.camera.elevation - observation.depth)
    return window.view(heights), window.view(mask) > 0.5
