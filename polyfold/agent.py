"""The ``polyfold`` agent: segmenter, grounding, planner and policy in a row (paper, Fig. 4)."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from polyfold.errors import PlanError
from polyfold.interfaces import Goal, Grounding, Planner, Policy, Segmenter
from polyfold.types import Action, Decision, FoldLine, Observation, Scene, Subgoal

__all__ = ["PolyFoldAgent"]


class PolyFoldAgent:
    """Splits the instruction, then per subgoal: ground the picture, plan a fold line, choose picks and places."""

    requires: ClassVar[frozenset[str]] = frozenset({"instruction"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "grounding", "planner", "policy")

    def __init__(self, segmenter: Segmenter, grounding: Grounding, planner: Planner, policy: Policy) -> None:
        self._segmenter = segmenter
        self._grounding = grounding
        self._planner = planner
        self._policy = policy

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Decompose the instruction. Raises RefusedError with the reason when it can't be done."""
        if goal.instruction is None or goal.conversation is None:
            raise PlanError("the polyfold agent needs an instruction and a language model; give it both")
        self._goal = goal
        self._rng = np.random.default_rng(goal.seed)
        self._scene: Scene | None = None
        self._fold_line: FoldLine | None = None
        self._pending = list(self._planner.subgoals(goal.instruction, goal.template, goal.conversation))
        return tuple(self._pending)

    def decide(self, observation: Observation) -> Decision | None:
        """Ground what is seen and plan the next subgoal; None after the last."""
        if not self._pending:
            return None
        assert self._goal.conversation is not None
        clock = time.perf_counter()
        mask = self._segmenter.segment(observation)
        scene = self._grounding.ground(observation, mask, self._goal.template, self._scene, self._fold_line)
        grounded = time.perf_counter()
        subgoal = self._pending[0]
        plan = self._planner.plan(subgoal, scene, self._goal.conversation)
        planned = time.perf_counter()
        action, fold_line = self._act(plan, scene)
        seconds = {
            "grounding": grounded - clock,
            "language": planned - grounded,
            "policy": time.perf_counter() - planned,
        }
        self._pending.pop(0)
        self._scene, self._fold_line = scene, fold_line
        return Decision(action, subgoal, fold_line, scene, seconds)

    def _act(self, plan: FoldLine | Action, scene: Scene) -> tuple[Action, FoldLine]:
        if isinstance(plan, FoldLine):
            return self._policy.act(plan, scene, self._rng), plan
        # A direct planner gives picks and places; the line that explains them is what the next grounding needs.
        return plan, FoldLine.moving(plan.picks.mean(axis=0), plan.places.mean(axis=0))
