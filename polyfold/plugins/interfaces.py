"""What each kind of component must do. Implement the methods; no base class is needed.

Every component class may carry a nested pydantic model ``Config``; its fields are the component's parameters on the
command line, in TOML and in notebooks, and an instance of it is the constructor's only argument. A class without
``Config`` takes no argument. Keep heavy imports inside methods, so that reading a ``Config`` stays cheap.

Methods are handed their arguments by place, in the order that stands here. The arrays of pictures, scenes and outcomes
are read-only while a component works on them: others do so after it. Copy what is to be changed.

Beside the protocol of each kind stand those of what a component may do as well; they are looked for with
``isinstance``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Fabric, Garment, Pattern
from polyfold.geometry import FoldLine
from polyfold.plugins._traits import (
    Configurable,
    MadeOf,
    MovedParameters,
    ReadsFiles,
    ReadsPrompts,
    TakesArgument,
    UsesComponents,
)
from polyfold.polygon import Template
from polyfold.types import Action, ActionMap, Decision, Observation, Outcome, Scene, SimState, Subgoal, Threshold
from polyfold.types._conversation import Message, Reply

__all__ = [
    "LLM",
    "Agent",
    "Configurable",
    "Conversation",
    "FabricKind",
    "GarmentKind",
    "Goal",
    "Grounding",
    "HasReferenceConfig",
    "LabelledMetric",
    "MadeOf",
    "Metric",
    "MovedParameters",
    "Planner",
    "Policy",
    "ReadsFiles",
    "ReadsPrompts",
    "RecordsMotion",
    "RoundedMetric",
    "Segmenter",
    "SewnKind",
    "Simulator",
    "StepwisePlanner",
    "SuccessCriterion",
    "TakesArgument",
    "UsesComponents",
    "ValuesPicks",
    "action_map_later",
]


@runtime_checkable
class Simulator(Protocol):
    """Cloth on a table under a camera, moved by one or two arms. Deterministic for a seed on one machine.

    One that is no simulation but a real table says so by ``unattended = False``, and its state is not known; studies,
    which fold the same garments again and again, refuse it.
    """

    def reset(self, garment: Garment, seed: int) -> Observation:
        """Lay the garment flat, at its own ``angle_deg`` or in a pose drawn from ``seed``; return the first picture."""
        ...

    def observe(self) -> Observation:
        """Take a picture."""
        ...

    def execute(self, action: Action) -> Observation:
        """Do one fold, let the cloth settle and take a picture.

        A pick off the cloth grasps nothing. Raises ActionError for pixels outside the image and SimulationError if the
        cloth diverges; the state before the fold is kept in both cases.
        """
        ...

    def state(self) -> SimState:
        """Privileged state, for metrics, oracle and rewards only."""
        ...

    def restore(self, state: SimState) -> None:
        """Return to a state of this garment, so that several picks can be tried from one."""
        ...

    def close(self) -> None:
        """Release what is held; the simulator can't be used afterwards."""
        ...


@runtime_checkable
class RecordsMotion(Protocol):
    """A simulator that can show the cloth while it moves, for animations."""

    def record(self, recorder: Callable[[Observation], Any], frames_per_second: float = 15.0) -> None:
        """Hand a picture to ``recorder`` so many times per simulated second, from now on."""
        ...


@runtime_checkable
class HasReferenceConfig(Protocol):
    """A simulator or segmenter that injects faults or noise, which results are not measured with."""

    @classmethod
    def reference_config(cls, config: Any) -> tuple[str, Mapping[str, Any]]:
        """Name and parameters of the one without: references are made in it, and the end is segmented by it."""
        ...


@runtime_checkable
class Segmenter(Protocol):
    """Finds the cloth in a picture.

    With a method ``doubts(observation, mask)`` it says what speaks against a mask, one line each; ``polyfold.ground``
    mentions them and is less sure.
    """

    def segment(self, observation: Observation) -> NDArray[np.bool_]:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when there is none."""
        ...


@runtime_checkable
class Grounding(Protocol):
    """Turns a picture into a scene: a pure function, so that an episode can resume."""

    def ground(
        self,
        observation: Observation,
        mask: NDArray[np.bool_],
        template: Template,
        previous: Scene | None = None,
        fold_line: FoldLine | None = None,
    ) -> Scene:
        """Ground one picture.

        Args:
            observation: the picture.
            mask: the segmented cloth, bool, shape (H, W).
            template: the polygon template of the garment's kind.
            previous: the scene before the last fold; None at the start.
            fold_line: the fold executed since ``previous``; None if nothing was folded.

        Raises:
            GroundingError: if the picture can't be explained.
        """
        ...


@runtime_checkable
class LLM(Protocol):
    """A chat model, real or rule-based. It sees only the messages."""

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer a conversation. Raises LLMError when no answer can be had."""
        ...


@runtime_checkable
class Conversation(Protocol):
    """The language model as the episode hands it to a planner: every exchange lands in the transcript."""

    def ask(self, role: str, messages: Sequence[Message], params: Mapping[str, Any] | None = None) -> Reply:
        """Ask in a role (``subgoals``, ``fold_line``, ...) and record messages and reply."""
        ...

    def reject(self, reason: str) -> None:
        """Record that the last reply can't be used, and why."""
        ...


@runtime_checkable
class Planner(Protocol):
    """Splits an instruction into subgoals and turns each into a fold line (or, for direct planners, an action)."""

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Decompose an instruction. Raises RefusedError with the reason when it can't or must not be done."""
        ...

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine | Action | Subgoal | None:
        """Plan one step on the scene as seen now; None when nothing is left to do.

        An earlier subgoal in place of a plan says that its flap has come open, so that it must be folded again first.

        Raises PlanError when no valid answer came after the repairs.
        """
        ...


@runtime_checkable
class StepwisePlanner(Planner, Protocol):
    """A planner that does not split instructions: it returns the instruction as its only subgoal.

    With ``decomposes = False`` it is asked to plan it again and again, each time on the scene as seen then, until it
    returns None.
    """

    decomposes: ClassVar[bool]


@runtime_checkable
class Policy(Protocol):
    """Chooses picks and places for a fold line."""

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Picks on the contour left of the line, places mirrored. Raises PlanError if no cloth lies left of it."""
        ...


@runtime_checkable
class ValuesPicks(Protocol):
    """What a policy may do besides: say how good it takes every place to pick for (paper, Fig. 9).

    Pictures of its folds then show it: filmstrips, the gallery of reports, ``polyfold maps``.
    """

    def action_map(self, fold_line: FoldLine, scene: Scene) -> ActionMap:
        """Places to pick [px], shape (N, 2), and their values, shape (N,); higher is better, not finite is not drawn.

        Called only when a picture is made, after the fold, so it must not change what the policy does. Raises
        PlanError if it has no values for this line; the picture then goes without.
        """
        ...


def action_map_later(policy: Policy, fold_line: FoldLine, scene: Scene) -> Callable[[], ActionMap] | None:
    """For a :class:`Decision`: a function that asks the policy once a picture is made; None if it can't say."""
    return partial(policy.action_map, fold_line, scene) if isinstance(policy, ValuesPicks) else None


@dataclass(frozen=True, eq=False)
class Goal:
    """What the loop hands an agent at the start: only what the agent ``requires``; the rest is None.

    Attributes:
        kind: garment kind.
        template: polygon template of the kind.
        seed: for the agent's own randomness.
        instruction: the sentence.
        conversation: the episode's language model.
        previous: the fold that led to the cloth as it lies, with the scene before it; None where nobody has folded it.
        subgoal_texts, subgoal_images, goal_image: accurate guidance, for agents that need it; with ``final`` guidance
            the subgoals are the goal alone.
        subgoal_depths: the same as the depth that a camera would measure [m], float32, shape (H, W) each.
        fold_count: how many folds the task takes; None where that is open.
        fold_lines: the ideal fold lines [px]; privileged.
        ideals: the ideal after each of them, beside the flat garment; privileged.
        state: function that returns the true state; privileged.
        simulator: the simulator itself, to try folds in; privileged.
    """

    kind: str
    template: Template
    seed: int
    instruction: str | None = None
    conversation: Conversation | None = None
    previous: Decision | None = None
    subgoal_texts: Sequence[str] | None = None
    subgoal_images: Sequence[NDArray[np.uint8]] | None = None
    subgoal_depths: Sequence[NDArray[np.float32]] | None = None
    goal_image: NDArray[np.uint8] | None = None
    fold_count: int | None = None
    fold_lines: Sequence[FoldLine] | None = None
    ideals: Sequence[Outcome] | None = None
    state: Any = None
    simulator: Any = None


@runtime_checkable
class Agent(Protocol):
    """Maps instruction and pictures to actions; ``polyfold`` composes grounding, planner, policy and LLM.

    ``requires`` is a subset of {"instruction", "fold_count", "subgoal_texts", "subgoal_images", "subgoal_depths",
    "goal_image", "fold_lines", "ideals", "state", "simulator"}; the last four are privileged and marked so wherever
    results are shown.
    """

    requires: ClassVar[frozenset[str]]

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Start an episode; return the subgoals, or an empty sequence if the agent has none."""
        ...

    def decide(self, observation: Observation) -> Decision | None:
        """The next action, or None when done."""
        ...


@runtime_checkable
class GarmentKind(Protocol):
    """A kind of garment: its polygon template and a generator of seeded instances."""

    kind: ClassVar[str]

    def template(self) -> Template:
        """The polygon template."""
        ...

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded garment, meshed at about ``edge_length`` [m]; the default is the kind's own.

        The same seed gives the same garment at every edge length. Its fabric is put in by the host.
        """
        ...


@runtime_checkable
class SewnKind(Protocol):
    """A kind of garment that says how it is sewn: real garments of it can be twinned and meshes imported."""

    pattern: ClassVar[Pattern]


@runtime_checkable
class FabricKind(Protocol):
    """What garments are made of. Its ``Config`` holds the constants, so that each can be overridden."""

    def fabric(self) -> Fabric:
        """The fabric. Raises GarmentError if a constant is not plausible."""
        ...


@runtime_checkable
class Metric(Protocol):
    """Scores how an episode ended against one or more references; the nearest reference counts.

    Attributes:
        unit: ``mm``, for example; empty if it has none.
        higher_is_better: which way is good.

    A metric may say as ``most`` what the largest value is that it can have: no interval in a table passes it then.
    """

    unit: ClassVar[str]
    higher_is_better: ClassVar[bool]

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The value, in ``unit``; NaN if there is nothing to measure."""
        ...


@runtime_checkable
class LabelledMetric(Protocol):
    """A metric that heads its column, without the unit; others are headed by their registered name."""

    label: ClassVar[str]


@runtime_checkable
class RoundedMetric(Protocol):
    """A metric that says with how many digits after the point it is shown; others are shown with one."""

    digits: ClassVar[int]


@runtime_checkable
class SuccessCriterion(Protocol):
    """What counts as success: bounds on metrics that all must hold against one and the same reference."""

    thresholds: ClassVar[Sequence[Threshold]]
