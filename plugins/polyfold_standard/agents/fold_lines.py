"""The task's true fold lines, picks by a policy: what a policy makes of perfect plans (paper, Table IV c)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import FoldLine, contour_of
from polyfold.plugins.interfaces import Goal, Grounding, Policy, Segmenter, action_map_later
from polyfold.types import Decision, Observation, Scene, Subgoal


class FoldLines:
    """Folds along the ideal lines from ground-truth keypoints, seen from nowhere; picks chosen by the policy."""

    requires: ClassVar[frozenset[str]] = frozenset({"fold_lines"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "grounding", "policy")

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        ground: bool = Field(
            default=False, description="ground every picture too, for policies that pick at polygon vertices"
        )

    def __init__(self, config: Config, segmenter: Segmenter, grounding: Grounding, policy: Policy) -> None:
        self._ground = config.ground
        self._segmenter = segmenter
        self._grounding = grounding
        self._policy = policy

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Take the true fold lines."""
        self._template = goal.template
        self._before: tuple[Scene, FoldLine] | None = None
        self._rng = np.random.default_rng(goal.seed)
        self._pending = list(goal.fold_lines or ())
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The next ideal line and its picks; None after the last."""
        if not self._pending:
            return None
        line = self._pending.pop(0)
        scene = self._seen(observation, self._segmenter.segment(observation))
        self._before = scene, line
        action = self._policy.act(line, scene, self._rng)
        return Decision(action, None, line, scene, action_map=action_map_later(self._policy, line, scene))

    def _seen(self, observation: Observation, mask: NDArray[np.bool_]) -> Scene:
        if self._ground:
            return self._grounding.ground(observation, mask, self._template, *(self._before or (None, None)))
        size = (observation.camera.width, observation.camera.height)
        return Scene(self._template.kind, size, mask, contour_of(mask), None, "{}")
