"""The baselines: agents that any method must beat, so that a metric which rewards them is seen to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal


class Noop:
    """Leaves the garment as it lies."""

    requires: ClassVar[frozenset[str]] = frozenset()

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Nothing to prepare."""
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """Done at once."""
        return None


class Random:
    """Two random picks on the cloth, carried across a random line through it; as many folds as the task takes."""

    requires: ClassVar[frozenset[str]] = frozenset({"fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)

    class Config(BaseModel):
        """Parameters of the random agent."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        folds: int = Field(default=2, ge=1, le=12, description="folds where the task leaves their number open")

    def __init__(self, config: Config, segmenter: Segmenter) -> None:
        self._folds = config.folds
        self._segmenter = segmenter

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Seed the choices of this episode."""
        self._rng = np.random.default_rng(goal.seed)
        self._left = goal.fold_count or self._folds
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """Draw a line through the cloth and two picks on its left; None after the last fold."""
        if self._left == 0:
            return None
        self._left -= 1
        cloth = np.argwhere(self._segmenter.segment(observation))[:, ::-1].astype(float)
        camera = observation.camera
        while True:
            through = self._rng.choice(cloth)
            angle = self._rng.uniform(0, 2 * np.pi)
            line = FoldLine.between(through, through + 50 * np.array([np.cos(angle), np.sin(angle)]))
            candidates = cloth[line.lifts(cloth)]
            if len(candidates) < 2:
                continue
            picks = self._rng.choice(candidates, size=2, replace=False)
            limit = [camera.width - 1, camera.height - 1]
            action = Action(picks, np.clip(line.mirror(picks), 0, limit))
            return Decision(action, fold_line=line)
