"""The one loop: see, decide, fold, see again. Everything that runs an episode runs this."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing

from polyfold import plugins
from polyfold.config import Experiment
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
from polyfold.garments import Garment
from polyfold.plugins._fabrics import garment_template
from polyfold.plugins.interfaces import Agent, Simulator, UsesComponents
from polyfold.rollout._inputs import PRIVILEGED, Start, goal_for
from polyfold.rollout._sentences import plain
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import Task
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


def build_agent(experiment: Experiment) -> Agent:
    """Construct the experiment's agent with the components that it is made of."""
    spec = experiment.agent
    agent = plugins.component_class("agents", spec.name.partition(":")[0])
    uses = agent.uses if isinstance(agent, UsesComponents) else ()
    components = {field: plugins.create_chosen(experiment, field) for field in uses}
    return plugins.create("agents", spec.name, spec.params, **components)


def run_episode(
    experiment: Experiment,
    garment: Garment,
    instruction: str,
    seed: int,
    simulator: Simulator | None = None,
    agent: Agent | None = None,
    task: Task | None = None,
    agent_seed: int | None = None,
    role: Role = "method",
    judge: Callable[[Episode], Episode] | None = None,
) -> Episode:
    """Run one episode from a sentence to the final picture.

    A refusal, a failed grounding, an unusable plan, a language model that can't be reached or a diverged fold ends the
    episode with ``failure`` set; what was done until then is kept. Other errors (a bug, a missing plugin, a key that is
    not accepted) are raised.

    Args:
        experiment: the components.
        garment: what lies on the table.
        instruction: what to do with it.
        seed: decides the pose on the table, and the agent's random choices unless ``agent_seed`` does.
        simulator, agent: instances to reuse; by default they are constructed from the experiment.
        task: what guidance is made from, for agents that require some.
        agent_seed: decides the agent's random choices.
        role: what observers are told that the episode is for.
        judge: scores the episode before observers are told of its end.

    Raises:
        ConfigError: if the agent requires guidance and no task is given, or the instruction is no text.
    """
    if simulator is None:
        with closing(plugins.create_chosen(experiment, "simulator")) as own:
            return run_episode(
                experiment, garment, instruction, seed, own, agent, task, agent_seed, role=role, judge=judge
            )
    instruction = plain(instruction)
    agent = agent or build_agent(experiment)
    transcript = Transcript(
        plugins.create_chosen(experiment, "llm") if "instruction" in agent.requires else None,
        {"task": task.id if task else None, "garment": garment.name, "seed": seed, "instruction": instruction},
    )
    clock = time.perf_counter()
    observation = simulator.reset(garment, seed)
    start = Start(experiment, garment, instruction, task, observation, simulator.state(), transcript, simulator)
    rollout = _Rollout(start, agent, role)
    rollout.seconds["reset"] = time.perf_counter() - clock
    agent_seed = seed if agent_seed is None else agent_seed
    error = rollout.run(seed, agent_seed)
    episode = rollout.episode(seed, agent_seed, error)
    episode = episode if judge is None else judge(episode)
    plugins.notify("on_episode_end", episode=episode, role=role)
    return episode


class _Rollout:
    """An episode while it runs."""

    def __init__(self, start: Start, agent: Agent, role: Role) -> None:
        self._start = start
        self._agent = agent
        self._role: Role = role
        self._subgoals: tuple[Subgoal, ...] = ()
        self._steps: list[Step] = []
        self._seen = start.observation
        self.seconds: dict[str, float] = {}

    def run(self, seed: int, agent_seed: int) -> PolyfoldError | None:
        """Decide and fold until the agent is done; returns what ended it early."""
        try:
            self._begin(seed, agent_seed)
            while len(self._steps) < MAX_STEPS and self._fold():
                pass
        except LLMAccessError:
            raise
        except tuple(kind for kind, _ in STAGES) as error:
            return error
        return None

    def _begin(self, seed: int, agent_seed: int) -> None:
        start = self._start
        clock = time.perf_counter()
        template = garment_template(start.garment.kind, start.garment.fabric)
        self._subgoals = tuple(self._agent.begin(goal_for(self._agent, start, template, agent_seed), self._seen))
        spent = self.seconds["subgoals"] = time.perf_counter() - clock
        told = EpisodeStart(start.instruction, start.garment, seed, self._subgoals, self._seen, spent)
        plugins.notify("on_episode_start", start=told, role=self._role)

    def _fold(self) -> bool:
        """One more fold; False if the agent is done."""
        self._start.transcript.step = len(self._steps)
        decision = self._agent.decide(self._seen)
        if decision is None:
            return False
        if "simulator" in self._agent.requires:
            # It may have put the cloth back to try again.
            self._seen = self._start.simulator.observe()
        step, self._seen = _executed(self._start.simulator, decision, self._seen, len(self._steps))
        self._steps.append(step)
        for stage, spent in step.seconds.items():
            self.seconds[stage] = self.seconds.get(stage, 0.0) + spent
        plugins.notify("on_step", step=step, role=self._role)
        return True

    def episode(self, seed: int, agent_seed: int, error: PolyfoldError | None) -> Episode:
        """What happened."""
        start = self._start
        return Episode(
            instruction=start.instruction,
            garment=start.garment,
            seed=seed,
            agent_seed=agent_seed,
            experiment=start.experiment,
            privileged=bool(PRIVILEGED & self._agent.requires),
            subgoals=self._subgoals,
            steps=tuple(self._steps),
            start=start.observation,
            final=self._seen,
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
