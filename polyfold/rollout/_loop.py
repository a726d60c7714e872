"""The one loop: see, decide, fold, see again. Everything that runs an episode runs this."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.errors import (
    ConfigError,
    GroundingError,
    LLMAccessError,
    LLMError,
    PlanError,
    PolyfoldError,
    RefusedError,
    SimulationError,
)
from polyfold.garments import Garment
from polyfold.plugins.interfaces import Agent, Goal, Simulator
from polyfold.rollout._privileged import guidance_for
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import Task
from polyfold.types import Decision, Observation, SimState, Subgoal
from polyfold.types._episode import Episode, EpisodeStart, Failure, Step

MAX_STEPS = 48
"""Folds, repeated ones included, after which an agent that never says it is done is stopped."""


GUIDED = frozenset({"subgoal_texts", "subgoal_images", "goal_image", "fold_lines"})


PRIVILEGED = frozenset({"fold_lines", "state", "simulator"})


def build_agent(experiment: Experiment) -> Agent:
    """Construct the experiment's agent with the components that its ``uses`` asks for."""
    choice = experiment.agent
    uses: Sequence[str] = getattr(plugins.component_class("agents", choice.name), "uses", ())
    components = {field: plugins.create_chosen(experiment, field) for field in uses}
    return plugins.create("agents", choice.name, choice.params, **components)


def run_episode(
    experiment: Experiment,
    garment: Garment,
    instruction: str,
    seed: int,
    simulator: Simulator | None = None,
    agent: Agent | None = None,
    task: Task | None = None,
    agent_seed: int | None = None,
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

    Raises:
        ConfigError: if the agent requires guidance and no task is given.
    """
    template = plugins.create("garments", garment.kind).template()
    agent = agent or build_agent(experiment)
    transcript = Transcript(
        plugins.create_chosen(experiment, "llm") if "instruction" in agent.requires else None,
        {"task": task.id if task else None, "garment": garment.name, "seed": seed, "instruction": instruction},
    )
    own_simulator = simulator is None
    simulator = simulator or plugins.create_chosen(experiment, "simulator")
    seconds: dict[str, float] = {}
    try:
        clock = time.perf_counter()
        observation = start = simulator.reset(garment, seed)
        initial_state = simulator.state()
        seconds["reset"] = time.perf_counter() - clock
        subgoals: tuple[Subgoal, ...] = ()
        steps: list[Step] = []
        error: PolyfoldError | None = None
        try:
            clock = time.perf_counter()
            goal = Goal(
                kind=garment.kind,
                template=template,
                seed=seed if agent_seed is None else agent_seed,
                **_told(agent.requires, instruction, transcript, simulator),
                **_guidance(agent.requires, experiment, instruction, task, garment, initial_state, start),
            )
            subgoals = tuple(agent.begin(goal, observation))
            seconds["subgoals"] = time.perf_counter() - clock
            plugins.notify(
                "on_episode_start",
                start=EpisodeStart(instruction, garment, seed, subgoals, observation, seconds["subgoals"]),
            )
            while len(steps) < MAX_STEPS:
                transcript.step = len(steps)
                decision = agent.decide(observation)
                if decision is None:
                    break
                step, observation = _execute(simulator, decision, observation, len(steps))
                steps.append(step)
                plugins.notify("on_step", step=step)
        except LLMAccessError:
            raise
        except (PlanError, GroundingError, SimulationError, LLMError) as caught:
            error = caught
        for step in steps:
            for stage, spent in step.seconds.items():
                seconds[stage] = seconds.get(stage, 0.0) + spent
        return Episode(
            instruction=instruction,
            garment=garment,
            seed=seed,
            experiment=experiment,
            privileged=bool(PRIVILEGED & agent.requires),
            subgoals=subgoals,
            steps=tuple(steps),
            start=start,
            final=observation,
            initial_state=initial_state,
            final_state=simulator.state(),
            calls=tuple(transcript.calls),
            seconds=seconds,
            failure=_failure(error),
            error=error,
        )
    finally:
        if own_simulator:
            simulator.close()


def _told(requires: frozenset[str], instruction: str, transcript: Transcript, simulator: Simulator) -> dict[str, Any]:
    """Of sentence and privileged access, what the agent requires; the rest is withheld."""
    unknown = requires - {"instruction", *GUIDED, *PRIVILEGED}
    if unknown:
        raise PlanError(f"the agent requires {sorted(unknown)}, which no loop can give; see polyfold.interfaces.Agent")
    told: dict[str, Any] = {}
    if "instruction" in requires:
        told |= {"instruction": instruction, "conversation": transcript}
    if "state" in requires:
        told["state"] = simulator.state
    if "simulator" in requires:
        told["simulator"] = simulator
    return told


def _guidance(
    requires: frozenset[str],
    experiment: Experiment,
    instruction: str,
    task: Task | None,
    garment: Garment,
    flat: SimState,
    seen: Observation,
) -> dict[str, Any]:
    """Of the guidance, what the agent requires; with ``final`` guidance the only subgoal is the goal."""
    if not requires & GUIDED:
        return {}
    if task is None:
        raise ConfigError("this agent needs guidance, which is made from a task; name one (--task)")
    made = guidance_for(task, garment, flat, seen)
    final = experiment.guidance == "final"
    offered = {
        "subgoal_texts": (instruction,) if final else made.subgoal_texts,
        "subgoal_images": (made.goal_image,) if final else made.subgoal_images,
        "goal_image": made.goal_image,
        "fold_lines": made.fold_lines,
    }
    return {name: value for name, value in offered.items() if name in requires}


def _execute(simulator: Simulator, decision: Decision, seen: Observation, index: int) -> tuple[Step, Observation]:
    clock = time.perf_counter()
    after = simulator.execute(decision.action)
    seconds = {**decision.seconds, "execution": time.perf_counter() - clock}
    step = Step(
        index,
        decision.subgoal,
        decision.fold_line,
        decision.scene,
        decision.action,
        seen,
        seconds,
        simulator.state(),
        decision.retry,
        decision.action_map,
    )
    return step, after


def _failure(error: PolyfoldError | None) -> Failure | None:
    if error is None:
        return None
    stages = {
        RefusedError: "refused",
        PlanError: "planning",
        GroundingError: "grounding",
        LLMError: "unanswered",
    }
    stage = next((name for kind, name in stages.items() if isinstance(error, kind)), "execution")
    return Failure(stage, str(error))
