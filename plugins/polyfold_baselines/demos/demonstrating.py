"""One demonstration: a task folded along its true lines on a training garment, step by step, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.plugins.interfaces import Agent, Goal
from polyfold.rollout import run_episode
from polyfold.tasks import Task
from polyfold.types import Decision, Episode, Observation, Subgoal
from polyfold_baselines.demos.window import SIDE, Window

Floats = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]

PER_METRE = 1e5
"""Heights are whole hundredths of a millimetre."""

LOWEST = 1e-5
"""What is higher than this above the table is cloth [m]: the thinnest fabric is ten times as thick."""

POLICIES = {1: "one-arm", 2: "affordance-pair"}


class DemoPlan(BaseModel):
    """What is demonstrated; the same plan and job give the same demonstration.

    Attributes:
        agent: who folds: ``fold-lines`` once along each line; ``oracle`` tries again until a fold is near the ideal;
            ``random-drags`` drags one point at random, and again.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    suite: str = Field(default="polyfold70", description="task suite")
    split: Literal["seen", "unseen"] = Field(default="seen", description="which of its tasks")
    tasks: tuple[str, ...] = Field(default=(), description="only these tasks, by id or pattern")
    arms: Literal[1, 2] = Field(default=2, description="with how many arms")
    agent: Literal["fold-lines", "oracle", "random-drags"] = Field(default="fold-lines", description="who folds")
    seeds: tuple[int, int] = Field(default=(1000, 1019), description="first and last garment seed, for each task")
    edge_length: float = Field(default=0.018, gt=0.005, le=0.05, description="edge length of the mesh [m]")
    simulator: ComponentSpec = Field(default=ComponentSpec(name="xpbd"), description="what folds")

    def check(self) -> None:
        """Raise ConfigError if a task that is chosen is not there, or is of the other half, or arms are too many."""
        if self.agent == "random-drags" and self.arms != 1:
            raise ConfigError("random drags are made with one arm; add --arms 1")
        for pattern in self.tasks:
            named = [task for task in suite(self.suite).matching([pattern]) if isinstance(task, Task)]
            if not any(task.split == self.split for task in named):
                other = "unseen" if self.split == "seen" else "seen"
                raise ConfigError(f"{pattern!r} names no {self.split} task; choose other tasks, or --split {other}")

    def jobs(self) -> list[tuple[Task, int]]:
        """The tasks and garment seeds, one demonstration each, in an order in which a part of them is balanced."""
        chosen = [
            entry
            for entry in suite(self.suite).matching(self.tasks or ("*",))
            if isinstance(entry, Task) and entry.split == self.split
        ]
        return [(task, seed) for seed in range(self.seeds[0], self.seeds[1] + 1) for task in chosen]


class _Watched:
    """An agent that keeps what another one is told."""

    requires: ClassVar[frozenset[str]]

    def __init__(self, agent: Agent) -> None:
        self.requires = agent.requires | {"subgoal_texts", "subgoal_depths", "ideals"}  # type: ignore[misc]
        self._agent = agent
        self.goal: Goal | None = None

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        self.goal = goal
        return self._agent.begin(goal, observation)

    def decide(self, observation: Observation) -> Decision | None:
        return self._agent.decide(observation)


def demonstrate(plan: DemoPlan, job: int) -> Arrays:
    """A demonstration, of K folds.

    Returns:
        ``height``, ``goal_height``: of the cloth before each fold and of the ideal after it, in hundredths of a
        millimetre, uint16, shape (K, SIDE, SIDE); ``mask``, ``goal_mask``: packed bits of the same views; ``picks``,
        ``places``: in the view, float32, shape (K, 2, 2), NaN for no second arm; ``error_mm``: how far all particles
        are from the ideal after the fold, shape (K,); ``text``: each fold in words; ``step``, ``steps``; ``task``,
        ``kind``, ``garment_seed``. Nothing of a demonstration that broke off.
    """
    task, seed = plan.jobs()[job]
    experiment = Experiment.of(
        agent=plan.agent, policy=POLICIES[plan.arms], simulator=plan.simulator.model_dump(), guidance="steps"
    )
    garment = plugins.generate_garment(task.garment, seed, plan.edge_length)
    watched = _Watched(_agent(experiment))
    episode = run_episode(experiment, garment, "", seed, agent=watched, task=task)
    if episode.error is not None or watched.goal is None:
        return {}
    return _as_arrays(episode, watched.goal, task)


def _agent(experiment: Experiment) -> Agent:
    components = {field: plugins.create_chosen(experiment, field) for field in ("segmenter", "grounding", "policy")}
    cls = plugins.component_class("agents", experiment.agent.name)
    return plugins.create("agents", experiment.agent.name, {}, **{name: components[name] for name in cls.uses})


def _as_arrays(episode: Episode, goal: Goal, task: Task) -> Arrays:
    segmenter = plugins.create("segmenters", "colour")
    window = Window.around(segmenter.segment(episode.start))
    steps = episode.final_attempts()
    rows = []
    for number, (step, depth, ideal) in enumerate(
        zip(steps, goal.subgoal_depths or (), goal.ideals or (), strict=True)
    ):
        camera = step.observation.camera
        wanted = camera.elevation - depth
        rows.append({
            "height": as_heights(window, camera.elevation - step.observation.depth),
            "mask": as_bits(window, segmenter.segment(step.observation)),
            "goal_height": as_heights(window, wanted),
            "goal_mask": as_bits(window, wanted > LOWEST),
            "picks": padded(window.to_view(step.action.picks)),
            "places": padded(window.to_view(step.action.places)),
            "error_mm": np.float32(1000 * np.linalg.norm(step.after.positions - ideal.end.positions, axis=1).mean()),
            "text": np.str_((goal.subgoal_texts or ())[number]),
            "step": np.int8(number),
            "steps": np.int8(len(steps)),
            "task": np.str_(task.id),
            "kind": np.str_(task.garment),
            "garment_seed": np.int32(episode.garment.seed or 0),
        })  # fmt: skip
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}


def as_heights(window: Window, heights: NDArray) -> NDArray[np.uint16]:
    """Heights above the table [m], shape (H, W), through the window, as they are stored."""
    seen = window.view(np.nan_to_num(heights))
    return (seen * PER_METRE).round().clip(0, np.iinfo(np.uint16).max).astype(np.uint16)


def as_bits(window: Window, mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """A mask, shape (H, W), through the window, as packed bits."""
    return np.packbits(window.view(mask) > 0.5)


def unpacked(bits: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Masks of views, shape (N, SIDE, SIDE), from their packed bits, shape (N, B)."""
    return np.unpackbits(bits, axis=-1).reshape(-1, SIDE, SIDE).astype(bool)


def padded(points: Floats) -> NDArray[np.float32]:
    """Points of one or two arms, shape (A, 2), as two, shape (2, 2): NaN for no second arm."""
    both = np.full((2, 2), np.nan, np.float32)
    both[: len(points)] = points
    return both
