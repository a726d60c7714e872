"""An episode as it happened: bare values, with the privileged states that scores are computed from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from polyfold._brief import brief
from polyfold.config import Experiment
from polyfold.errors import (
    PolyfoldError,
)
from polyfold.garments import Garment
from polyfold.geometry import FoldLine
from polyfold.types._conversation import Call
from polyfold.types._decisions import Action, ActionMap, Subgoal
from polyfold.types._fidelity import Fidelity
from polyfold.types._perception import Observation, Scene
from polyfold.types._state import SimState
from polyfold.types._views import view_of

Role = Literal["method", "reference"]
"""Whether an episode was asked for, or is the oracle's own that others are compared with."""


@dataclass(frozen=True, eq=False, repr=False)
class EpisodeStart:
    """What observers are told when an episode begins."""

    instruction: str
    garment: Garment
    seed: int
    subgoals: tuple[Subgoal, ...]
    observation: Observation
    seconds: float

    __repr__ = brief


SHORT = 0.005
"""Stops that are nearer to their places than this are not worth a word [m]."""
LOST = 0.5
"""An arm has lost the cloth if this share of what it took slipped out of its grip."""


@dataclass(frozen=True, eq=False, repr=False)
class Step:
    """One executed fold.

    Attributes:
        index: 0 for the first fold.
        subgoal, fold_line, scene: what led to the action, where the agent has them.
        action: the picks and places that were executed.
        observation: the picture it was decided on.
        seconds: time per stage (``grounding``, ``language``, ``policy``, ``execution``) [s].
        after: the true state once the cloth has settled, for metrics.
        retry: whether it repeats the fold before, which was seen to have failed.
        action_map: computes what the policy thinks of every place to pick; None where it can't say.
    """

    index: int
    subgoal: Subgoal | None
    fold_line: FoldLine | None
    scene: Scene | None
    action: Action
    observation: Observation
    seconds: dict[str, float]
    after: SimState
    retry: bool = False
    action_map: Callable[[], ActionMap] | None = None

    __repr__ = brief

    def in_words(self) -> str:
        """How many arms folded, and what went wrong with their grips, as far as the simulator says."""
        told = ["one arm" if self.action.arms == 1 else "two arms"]
        picks = list(enumerate(self.action.picks, 1))
        empty = [
            f"arm {arm} at ({x:.0f}, {y:.0f})"
            for (arm, (x, y)), plies in zip(picks, self.after.grasped or (), strict=False)
            if plies == 0
        ]
        short = [f"arm {arm} {1000 * way:.0f} mm" for arm, way in enumerate(self.after.short or (), 1) if way >= SHORT]
        lost = [f"arm {arm}" for arm, share in enumerate(self.after.slipped or (), 1) if share >= LOST]
        if empty:
            told.append(f"no cloth in the grip of {' and '.join(empty)}")
        if short:
            told.append(f"the cloth reaches no farther: {' and '.join(short)} short of its place")
        if lost:
            told.append(f"the cloth slipped out of the grip of {' and '.join(lost)}")
        return ", ".join(told)


@dataclass(frozen=True)
class Failure:
    """Why an episode ended early.

    Attributes:
        stage: ``refused``, ``grounding``, ``planning``, ``unanswered`` (nothing came from the language model),
            ``policy`` (picks or places outside the image),
            ``execution``, or in studies ``infrastructure`` (there was nothing to compare with, or no guidance).
        reason: the error's message.
    """

    stage: str
    reason: str


@dataclass(frozen=True, eq=False, repr=False)
class Episode:
    """Everything that happened, with the privileged states that scores are computed from.

    Attributes:
        seed: of how the garment lay.
        agent_seed: of the agent's random choices.
        privileged: whether the agent was told more than a camera sees.
        calls: every request to the language model, in order.
        seconds: time per stage, summed over the steps, ``reset`` and ``subgoals`` included [s].
        fidelity: how close the result came to the ideal fold; None when nothing was folded.
        ideal_lines: the fold lines of that ideal [px].
    """

    instruction: str
    garment: Garment
    seed: int
    agent_seed: int
    experiment: Experiment
    privileged: bool
    subgoals: tuple[Subgoal, ...]
    steps: tuple[Step, ...]
    start: Observation
    final: Observation
    initial_state: SimState
    final_state: SimState
    calls: tuple[Call, ...]
    seconds: dict[str, float]
    failure: Failure | None = None
    error: PolyfoldError | None = None
    task: str | None = None
    fidelity: Fidelity | None = None
    ideal_lines: tuple[FoldLine, ...] = ()

    def __repr__(self) -> str:
        folds = "1 fold" if len(self.steps) == 1 else f"{len(self.steps)} folds"
        outcome = f", {self.fidelity.in_words(self.task)}" if self.fidelity is not None else ""
        stopped = f", stopped in {self.failure.stage}: {self.failure.reason}" if self.failure is not None else ""
        return f"<Episode: {self.garment.name}, “{self.instruction}”, {folds}{outcome}{stopped}>"

    def final_attempts(self) -> list[Step]:
        """One step per planned fold: the last try of each."""
        repeated = [step.retry for step in self.steps[1:]] + [False]
        return [step for step, again in zip(self.steps, repeated, strict=False) if not again]

    def summary(self) -> dict[str, Any]:
        """The episode as plain data, as ``episode.json`` and ``polyfold fold --json`` have it."""
        return view_of(self, "summary")

    def show(self, path: str | Path | None = None) -> NDArray[np.uint8]:
        """The filmstrip, uint8, shape (H, W, 3); also written to a ``path``: PNG, or PDF or SVG for papers."""
        return view_of(self, "filmstrip", path)

    def show_result(self) -> NDArray[np.uint8]:
        """The last picture with the ideal outline dashed over it, uint8, shape (H, W, 3)."""
        return view_of(self, "result")

    def _repr_html_(self) -> str:
        return view_of(self, "html")
