"""The oracle: the task's true fold lines, picks by a policy on them. Its end state is what others are compared with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from polyfold.geometry import contour_of
from polyfold.interfaces import Goal, Policy, Segmenter
from polyfold.types import Decision, Observation, Scene, Subgoal

__all__ = ["Oracle"]


class Oracle:
    """Folds along the ideal lines from ground-truth keypoints, seen from nowhere; picks chosen by the policy."""

    requires: ClassVar[frozenset[str]] = frozenset({"fold_lines"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "policy")

    def __init__(self, segmenter: Segmenter, policy: Policy) -> None:
        self._segmenter = segmenter
        self._policy = policy

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Take the lines from the guidance."""
        self._kind = goal.kind
        self._rng = np.random.default_rng(goal.seed)
        self._pending = list(goal.fold_lines or ())
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The next ideal line and its picks; None after the last."""
        if not self._pending:
            return None
        line = self._pending.pop(0)
        mask = self._segmenter.segment(observation)
        size = (observation.camera.width, observation.camera.height)
        scene = Scene(self._kind, size, mask, contour_of(mask), None, "{}")
        return Decision(self._policy.act(line, scene, self._rng), fold_line=line, scene=scene)
