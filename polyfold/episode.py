"""The one loop: see, decide, fold, see again. Everything that runs an episode runs this."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.errors import GroundingError, PlanError, PolyfoldError, RefusedError, SimulationError
from polyfold.garments import Garment
from polyfold.interfaces import Agent, Goal, Simulator
from polyfold.transcript import Transcript
from polyfold.types import Action, Decision, FoldLine, Observation, Scene, SimState, Subgoal

if TYPE_CHECKING:
    from polyfold.ideal import Fidelity

__all__ = ["MAX_STEPS", "Episode", "EpisodeStart", "Failure", "Step", "build_agent", "run_episode"]

MAX_STEPS = 12
"""Folds after which an agent that never says it is done is stopped."""

PRIVILEGED = frozenset({"state", "simulator"})


@dataclass(frozen=True, eq=False)
class EpisodeStart:
    """What observers are told when an episode begins."""

    instruction: str
    garment: Garment
    seed: int
    subgoals: tuple[Subgoal, ...]
    observation: Observation
    seconds: float


@dataclass(frozen=True, eq=False)
class Step:
    """One executed fold.

    Attributes:
        index: 0 for the first fold.
        subgoal, fold_line, scene: what led to the action, where the agent has them.
        action: the picks and places that were executed.
        observation: the picture it was decided on.
        seconds: time per stage (``grounding``, ``language``, ``policy``, ``execution``) [s].
    """

    index: int
    subgoal: Subgoal | None
    fold_line: FoldLine | None
    scene: Scene | None
    action: Action
    observation: Observation
    seconds: dict[str, float]


@dataclass(frozen=True)
class Failure:
    """Why an episode ended early: the stage (``refused``, ``grounding``, ``planning``, ``execution``), the reason."""

    stage: str
    reason: str


@dataclass(frozen=True, eq=False)
class Episode:
    """Everything that happened, with the privileged states that scores are computed from.

    Attributes:
        seconds: time per stage, summed over the steps, ``reset`` and ``subgoals`` included [s].
        fidelity: how close the result came to the ideal fold; None when nothing was folded.
        ideal_lines: the fold lines of that ideal [px].
    """

    instruction: str
    garment: Garment
    seed: int
    experiment: Experiment
    privileged: bool
    subgoals: tuple[Subgoal, ...]
    steps: tuple[Step, ...]
    start: Observation
    final: Observation
    initial_state: SimState
    final_state: SimState
    transcript: Transcript
    seconds: dict[str, float]
    failure: Failure | None = None
    error: PolyfoldError | None = None
    task: str | None = None
    fidelity: Fidelity | None = None
    ideal_lines: tuple[FoldLine, ...] = ()

    def summary(self) -> dict[str, Any]:
        """The episode as plain data, as ``episode.json`` and ``polyfold fold --json`` have it."""
        from polyfold.record import summary

        return summary(self)

    def show(self) -> Any:
        """The filmstrip as an RGB array, uint8, shape (H, W, 3)."""
        from polyfold.pictures import filmstrip_of

        return filmstrip_of(self)

    def show_result(self) -> Any:
        """The last picture with the ideal outline dashed over it, uint8, shape (H, W, 3)."""
        from polyfold.pictures import result_of

        return result_of(self)

    def _repr_html_(self) -> str:
        from polyfold.pictures import episode_html

        return episode_html(self)


def build_agent(experiment: Experiment) -> Agent:
    """Construct the experiment's agent with the components that its ``uses`` asks for."""
    kinds = {"policy": "policies"}
    name, params = experiment.agent.name, experiment.agent.params
    uses: Sequence[str] = getattr(plugins.component_class("agents", name), "uses", ())
    components = {field: experiment.create(kinds.get(field, f"{field}s"), field) for field in uses}
    return plugins.create("agents", name, params, **components)


def run_episode(
    experiment: Experiment,
    garment: Garment,
    instruction: str,
    seed: int,
    simulator: Simulator | None = None,
    agent: Agent | None = None,
) -> Episode:
    """Run one episode from a sentence to the final picture.

    A refusal, a failed grounding, an unusable plan or a diverged fold ends the episode with ``failure`` set; what was
    done until then is kept. Other errors (a bug, a missing plugin) are raised.

    Args:
        experiment: the components.
        garment: what lies on the table.
        instruction: what to do with it.
        seed: decides the pose on the table and the agent's random choices.
        simulator, agent: instances to reuse; by default they are constructed from the experiment.
    """
    template = plugins.create("garments", garment.kind).template()
    agent = agent or build_agent(experiment)
    transcript = Transcript(experiment.create("llms", "llm") if "instruction" in agent.requires else None)
    own_simulator = simulator is None
    simulator = simulator or experiment.create("simulators", "simulator")
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
            goal = _goal(agent, instruction, garment.kind, template, seed, transcript, simulator)
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
        except (PlanError, GroundingError, SimulationError) as caught:
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
            transcript=transcript,
            seconds=seconds,
            failure=_failure(error),
            error=error,
        )
    finally:
        if own_simulator:
            simulator.close()


def _goal(
    agent: Agent, instruction: str, kind: str, template: Any, seed: int, transcript: Transcript, simulator: Simulator
) -> Goal:
    """Hand the agent what it requires and withhold the rest."""
    requires = agent.requires
    unknown = requires - {"instruction", "subgoal_texts", "subgoal_images", "goal_image", *PRIVILEGED}
    if unknown:
        raise PlanError(f"the agent requires {sorted(unknown)}, which no loop can give; see polyfold.interfaces.Agent")
    return Goal(
        instruction=instruction if "instruction" in requires else None,
        kind=kind,
        template=template,
        seed=seed,
        conversation=transcript if "instruction" in requires else None,
        state=simulator.state if "state" in requires else None,
        simulator=simulator if "simulator" in requires else None,
    )


def _execute(simulator: Simulator, decision: Decision, seen: Observation, index: int) -> tuple[Step, Observation]:
    clock = time.perf_counter()
    after = simulator.execute(decision.action)
    seconds = {**decision.seconds, "execution": time.perf_counter() - clock}
    step = Step(index, decision.subgoal, decision.fold_line, decision.scene, decision.action, seen, seconds)
    return step, after


def _failure(error: PolyfoldError | None) -> Failure | None:
    if error is None:
        return None
    stages = {RefusedError: "refused", PlanError: "planning", GroundingError: "grounding"}
    stage = next((name for kind, name in stages.items() if isinstance(error, kind)), "execution")
    return Failure(stage, str(error))
