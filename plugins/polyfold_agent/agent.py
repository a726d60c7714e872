"""The ``polyfold`` agent: segmenter, grounding, planner and policy in a row (paper, Fig. 4), with recovery."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import PlanError
from polyfold.geometry import Camera, FoldLine, contour_of
from polyfold.plugins.interfaces import (
    Conversation,
    Goal,
    Grounding,
    Planner,
    Policy,
    Segmenter,
    StepwisePlanner,
    action_map_later,
)
from polyfold.types import Action, ActionMap, Decision, Observation, Scene, Subgoal
from polyfold_agent.recovery import Attempt, inspect

_ActionMapLater = Callable[[], ActionMap] | None


class PolyFoldAgent:
    """Splits the instruction, then per subgoal: ground the picture, plan a fold line, choose picks and places.

    After each fold the next picture tells whether it took effect (:mod:`polyfold_agent.recovery`). Cloth that an arm
    missed or left astray is carried to where it belongs; in other cases the policy folds what is still left of the line
    once more. A fold is set right a bounded number of times. The line moves with a garment that was displaced.
    """

    requires: ClassVar[frozenset[str]] = frozenset({"instruction"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "grounding", "planner", "policy")

    class Config(BaseModel):
        """Parameters of the recovery."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        recover: bool = Field(default=True, description="look whether a fold took effect and repeat it if not")
        retries: int = Field(default=3, ge=0, le=10, description="times that one fold is repeated at most")
        remaining: float = Field(
            default=0.25,
            gt=0,
            lt=1,
            description="share of the flap's depth that, still left of the line, means a failed fold",
        )
        astray: float = Field(
            default=0.22,
            gt=0,
            lt=1,
            description="share of the flap's depth by which cloth beyond the expected outline does",
        )

    def __init__(
        self, config: Config, segmenter: Segmenter, grounding: Grounding, planner: Planner, policy: Policy
    ) -> None:
        self._config = config
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
        self._last: Decision | None = None
        self._tries = 0
        self._reopened: set[str] = set()
        template = goal.template.of_size(*_size(self._spread_flat(goal.previous, observation), observation.camera))
        self._pending = list(self._planner.subgoals(goal.instruction, template, goal.conversation))
        return tuple(self._pending)

    def _spread_flat(self, previous: Decision | None, observation: Observation) -> NDArray[np.floating]:
        """Points over or around the flat garment [px], shape (N, 2): what is seen, or what was before it was folded."""
        if previous is not None and previous.scene is not None and previous.scene.model is not None:
            return previous.scene.model.rest
        return np.argwhere(self._segmenter.segment(observation))[:, ::-1].astype(float)

    def decide(self, observation: Observation) -> Decision | None:
        """Repeat the last fold if it failed, else ground and plan the next subgoal; None after the last."""
        if not self._pending and not self._can_repeat():
            return None
        clock = time.perf_counter()
        mask = self._segmenter.segment(observation)
        decision = self._repeated(observation, mask, clock) or self._planned(observation, mask, clock)
        if decision is not None:
            self._tries = self._tries + 1 if decision.retry else 0
            self._last = decision
        return decision

    def _planned(self, observation: Observation, mask: NDArray[np.bool_], clock: float) -> Decision | None:
        """The next subgoal on what is seen now."""
        if not self._pending:
            return None
        assert self._goal.conversation is not None
        before = self._last or self._goal.previous
        scene = self._grounding.ground(
            observation,
            mask,
            self._goal.template,
            None if before is None else before.scene,
            None if before is None else before.fold_line,
        )
        grounded = time.perf_counter()
        subgoal, plan = self._next_plan(scene, self._goal.conversation)
        planned = time.perf_counter()
        if plan is None or not _plans_step_by_step(self._planner):
            self._pending.pop(0)
        if plan is None:
            return None
        action, line, action_map = self._act(plan, scene)
        self._attempt = Attempt(observation, mask, line, action)
        seconds = {"grounding": grounded - clock, "language": planned - grounded, "policy": _since(planned)}
        return Decision(action, subgoal, line, scene, seconds, action_map=action_map)

    def _next_plan(self, scene: Scene, conversation: Conversation) -> tuple[Subgoal, FoldLine | Action | None]:
        """The next subgoal and its plan; one whose flap has come open goes before it, once."""
        subgoal = self._pending[0]
        plan = self._planner.plan(subgoal, scene, conversation)
        if not isinstance(plan, Subgoal):
            return subgoal, plan
        if plan.text in self._reopened:
            raise PlanError(f"“{plan.text}” was folded twice and has come open again; leave it out, or fold it last")
        self._reopened.add(plan.text)
        self._pending.insert(0, plan)
        return self._next_plan(scene, conversation)

    def _can_repeat(self) -> bool:
        return self._config.recover and self._last is not None and self._tries < self._config.retries

    def _repeated(self, observation: Observation, mask: NDArray[np.bool_], clock: float) -> Decision | None:
        """What sets the last fold right; None if it took effect."""
        if not self._can_repeat():
            return None
        last, attempt, config = self._last, self._attempt, self._config
        assert last is not None
        assert last.scene is not None
        finding, motion = inspect(attempt, observation, mask, config.remaining, config.astray)
        if finding is None:
            return None
        looked = time.perf_counter()
        line = motion.line(attempt.line)
        action, action_map = finding.action, None
        if action is None:
            again = self._folded_again(line, replace(last.scene, mask=mask, contour=contour_of(mask)))
            if again is None:
                return None
            action, action_map = again
        # Line and scene stay those before the fold: that is what the next grounding starts from.
        seconds = {"grounding": looked - clock, "language": 0.0, "policy": _since(looked)}
        return replace(last, action=action, seconds=seconds, retry=True, action_map=action_map)

    def _folded_again(self, line: FoldLine, scene: Scene) -> tuple[Action, _ActionMapLater] | None:
        """The policy's picks on what is still left of the line; None where it finds nothing to take there."""
        try:
            return self._policy.act(line, scene, self._rng), action_map_later(self._policy, line, scene)
        except PlanError:
            return None

    def _act(self, plan: FoldLine | Action, scene: Scene) -> tuple[Action, FoldLine, _ActionMapLater]:
        if isinstance(plan, FoldLine):
            return self._policy.act(plan, scene, self._rng), plan, action_map_later(self._policy, plan, scene)
        # A direct planner gives picks and places; the line that explains them is what the next grounding needs.
        return plan, FoldLine.moving(plan.picks.mean(axis=0), plan.places.mean(axis=0)), None


def _plans_step_by_step(planner: Planner) -> bool:
    """Whether the instruction is planned again on every scene, instead of one subgoal after the other."""
    return isinstance(planner, StepwisePlanner) and not planner.decomposes


def _size(points: NDArray[np.floating], camera: Camera) -> tuple[float, float]:
    """Width and height of flat cloth [m], along the sides of the smallest rectangle around it nearest to upright."""
    import cv2

    corners = cv2.boxPoints(cv2.minAreaRect(points.astype(np.float32)))
    sides = np.array([corners[1] - corners[0], corners[2] - corners[1]])
    lengths = (np.hypot(*sides.T) + 1) / camera.pixels_per_metre
    across = int(np.argmax(np.abs(sides[:, 0]) / np.hypot(*sides.T)))
    return float(lengths[across]), float(lengths[1 - across])


def _since(clock: float) -> float:
    return time.perf_counter() - clock
