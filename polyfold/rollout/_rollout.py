"""An episode while it runs: folds are added and taken back; what has happened can be told at any time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import NamedTuple

from polyfold import plugins
from polyfold.errors import (
    ActionError,
    GroundingError,
    LLMAccessError,
    LLMError,
    PlanError,
    PolyfoldError,
    RefusedError,
    RobotError,
    SimulationError,
)
from polyfold.plugins._fabrics import garment_template
from polyfold.plugins.interfaces import Agent, Simulator
from polyfold.rollout._inputs import PRIVILEGED, Start, goal_for
from polyfold.types import Decision, Episode, EpisodeStart, Failure, Observation, Role, Step, Subgoal

MAX_STEPS = 48
"""Folds, repeated ones included, after which an agent that never says it is done is stopped."""

STAGES: Sequence[tuple[type[PolyfoldError], str]] = (
    (RefusedError, "refused"),
    (PlanError, "planning"),
    (GroundingError, "grounding"),
    (LLMError, "unanswered"),
    (ActionError, "policy"),
    (SimulationError, "execution"),
    (RobotError, "execution"),
)
"""Errors that end an episode, and the stage of its failure; the first that fits counts."""


class Mark(NamedTuple):
    """How far an episode has come: numbers of folds, subgoals and requests."""

    steps: int
    subgoals: int
    calls: int


class Rollout:
    """An episode while it runs.

    Attributes:
        start: how it began.
        subgoals: what the agents meant to do, in words.
        steps: the folds so far.
        seen: the last picture.
        seconds: time per stage [s].
        privileged: whether an agent was told more than a camera sees.
    """

    def __init__(self, start: Start, role: Role = "method") -> None:
        self.start = start
        self._role: Role = role
        self.subgoals: tuple[Subgoal, ...] = ()
        self.steps: list[Step] = []
        self.seen = start.observation
        self.seconds: dict[str, float] = {}
        self.privileged = False

    def follow(self, agent: Agent, instruction: str, seed: int, agent_seed: int) -> PolyfoldError | None:
        """Decide and fold until the agent is done; returns what ended it early."""
        self.privileged |= bool(PRIVILEGED & agent.requires)
        most = len(self.steps) + MAX_STEPS
        try:
            self._begin(agent, instruction, seed, agent_seed)
            while len(self.steps) < most and self._next(agent):
                pass
        except LLMAccessError:
            raise
        except tuple(kind for kind, _ in STAGES) as error:
            return error
        return None

    def _begin(self, agent: Agent, instruction: str, seed: int, agent_seed: int) -> None:
        start = self.start
        clock = time.perf_counter()
        template = garment_template(start.garment.kind, start.garment.fabric)
        goal = goal_for(agent, start, template, agent_seed, instruction, self._previous())
        begun = tuple(agent.begin(goal, self.seen))
        self.subgoals += begun
        spent = time.perf_counter() - clock
        self._spend("subgoals", spent)
        told = EpisodeStart(instruction, start.garment, seed, begun, self.seen, spent)
        plugins.notify("on_episode_start", start=told, role=self._role)

    def _previous(self) -> Decision | None:
        """What led to the cloth as it lies now."""
        if not self.steps:
            return None
        last = self.steps[-1]
        return Decision(last.action, last.subgoal, last.fold_line, last.scene)

    def _next(self, agent: Agent) -> bool:
        """One more fold; False if the agent is done."""
        self.start.transcript.step = len(self.steps)
        decision = agent.decide(self.seen)
        if decision is None:
            return False
        if "simulator" in agent.requires:
            # It may have put the cloth back to try again.
            self.seen = self.start.simulator.observe()
        self.execute(decision)
        return True

    def execute(self, decision: Decision) -> Step:
        """Do one fold. Raises as :meth:`polyfold.plugins.interfaces.Simulator.execute`; nothing is added then."""
        step, self.seen = _executed(self.start.simulator, decision, self.seen, len(self.steps))
        self.steps.append(step)
        for stage, spent in step.seconds.items():
            self._spend(stage, spent)
        plugins.notify("on_step", step=step, role=self._role)
        return step

    def mark(self) -> Mark:
        """How far it has come, for :meth:`go_back`."""
        return Mark(len(self.steps), len(self.subgoals), len(self.start.transcript.calls))

    def go_back(self, mark: Mark) -> None:
        """Undo everything since a mark: the cloth lies as then, and nothing that was said since is told."""
        undone = self.steps[mark.steps :]
        del self.steps[mark.steps :], self.start.transcript.calls[mark.calls :]
        self.subgoals = self.subgoals[: mark.subgoals]
        self.start.simulator.restore(self.steps[-1].after if self.steps else self.start.state)
        if undone:
            self.seen = undone[0].observation

    def _spend(self, stage: str, seconds: float) -> None:
        self.seconds[stage] = self.seconds.get(stage, 0.0) + seconds

    def episode(self, seed: int, agent_seed: int, error: PolyfoldError | None = None) -> Episode:
        """What happened."""
        start = self.start
        return Episode(
            instruction=start.instruction,
            garment=start.garment,
            seed=seed,
            agent_seed=agent_seed,
            experiment=start.experiment,
            privileged=self.privileged,
            subgoals=self.subgoals,
            steps=tuple(self.steps),
            start=start.observation,
            final=self.seen,
            initial_state=start.state,
            final_state=start.simulator.state(),
            calls=tuple(start.transcript.calls),
            seconds=self.seconds,
            failure=None if error is None else Failure(_stage(error), str(error)),
            error=error,
        )


def _executed(simulator: Simulator, decision: Decision, seen: Observation, index: int) -> tuple[Step, Observation]:
    """The step of a decision, and the picture after it."""
    clock = time.perf_counter()
    after = simulator.execute(decision.action)
    seconds = {**decision.seconds, "execution": time.perf_counter() - clock}
    step = Step(
        index=index,
        subgoal=decision.subgoal,
        fold_line=decision.fold_line,
        scene=decision.scene,
        action=decision.action,
        observation=seen,
        seconds=seconds,
        after=simulator.state(),
        retry=decision.retry,
        action_map=decision.action_map,
    )
    return step, after


def _stage(error: PolyfoldError) -> str:
    return next(stage for kind, stage in STAGES if isinstance(error, kind))
