"""What an agent is told: of all that the loop could say, no more than the agent requires."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from polyfold.config import Experiment
from polyfold.errors import ConfigError, PlanError
from polyfold.garments import Garment
from polyfold.plugins.interfaces import Agent, Goal, Simulator
from polyfold.polygon import Template
from polyfold.rollout._privileged import privileged_inputs
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import Task
from polyfold.types import Decision, Observation, SimState

GUIDED = frozenset({"subgoal_texts", "subgoal_images", "subgoal_depths", "goal_image", "fold_lines", "ideals"})
"""What is made from a task and the true keypoints."""

PRIVILEGED = frozenset({"fold_lines", "ideals", "state", "simulator"})
"""What no camera and no person could tell; agents that require it are marked wherever results are shown."""


@dataclass(frozen=True, eq=False)
class Start:
    """How an episode begins.

    Attributes:
        experiment: the components.
        garment: what lies on the table.
        instruction: what to do with it.
        task: what guidance is made from; None where there is none.
        observation: the first picture.
        state: the true state.
        transcript: the way to the language model.
        simulator: where the garment lies.
    """

    experiment: Experiment
    garment: Garment
    instruction: str
    task: Task | None
    observation: Observation
    state: SimState
    transcript: Transcript
    simulator: Simulator


def goal_for(
    agent: Agent,
    start: Start,
    template: Template,
    agent_seed: int,
    instruction: str,
    previous: Decision | None = None,
) -> Goal:
    """What an agent is handed at the start.

    Args:
        agent: whose goal it is.
        start: how the episode began.
        template: polygon template of the garment's kind.
        agent_seed: for the agent's own randomness.
        instruction: the sentence.
        previous: the fold that led to the cloth as it lies; None where nobody has folded it yet.

    Raises:
        PlanError: if it requires what no loop can give.
        ConfigError: if it requires guidance and there is no task to make it from.
    """
    requires = agent.requires
    unknown = requires - {"instruction", "fold_count", *GUIDED, *PRIVILEGED}
    if unknown:
        raise PlanError(
            f"the agent requires {sorted(unknown)}, which no loop can give; see polyfold.plugins.interfaces.Agent"
        )
    offered = _offered(start, instruction)
    if requires & GUIDED:
        offered |= _guidance(start)
    told = {name: value for name, value in offered.items() if name in requires}
    conversation = start.transcript if "instruction" in requires else None
    return Goal(
        kind=start.garment.kind,
        template=template,
        seed=agent_seed,
        conversation=conversation,
        previous=previous,
        **told,
    )


def _offered(start: Start, instruction: str) -> dict[str, Any]:
    return {
        "instruction": instruction,
        "fold_count": None if start.task is None else len(start.task.steps),
        "state": start.simulator.state,
        "simulator": start.simulator,
    }


def _guidance(start: Start) -> dict[str, Any]:
    """Accurate help; with ``final`` guidance the only subgoal is the goal."""
    if start.task is None:
        raise ConfigError("this agent needs guidance, which is made from a task; name one (--task)")
    if not start.state.known:
        raise ConfigError(
            "this agent needs guidance, which is made from true keypoints, and of real cloth nobody knows them; "
            "use an agent that looks, such as polyfold"
        )
    made = privileged_inputs(start.task, start.garment, start.state, start.observation)
    final = start.experiment.guidance == "final"
    return {
        "subgoal_texts": (start.instruction,) if final else made.subgoal_texts,
        "subgoal_images": (made.goal_image,) if final else made.subgoal_images,
        "subgoal_depths": made.subgoal_depths[-1:] if final else made.subgoal_depths,
        "goal_image": made.goal_image,
        "fold_lines": made.fold_lines,
        "ideals": made.ideals,
    }
