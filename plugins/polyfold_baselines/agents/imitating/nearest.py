"""``nearest-demo``: the closest demonstration, copied. The floor for whatever learns from demonstrations.

It has no source: any imitation that is worth its training must be better.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError, PlanError
from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal
from polyfold_baselines.agents.goals import GoalPictures
from polyfold_baselines.demos.demonstrating import unpacked
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import on_cloth

Floats = NDArray[np.float64]


class NearestDemo:
    """Does what was done in the demonstration whose cloth and goal look most alike, by the overlap of both."""

    requires: ClassVar[frozenset[str]] = frozenset({"subgoal_depths", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        demos: Path = Field(description="folder of `polyfold demos`")

    def __init__(self, config: Config, segmenter: Segmenter) -> None:
        self._demos = _read(config.demos.resolve(), _version(config.demos / "dataset.json"))
        self._segmenter = segmenter

    @classmethod
    def files_read(cls, config: Config) -> list[Path]:
        """What says which demonstrations they are."""
        return [config.demos / "dataset.json"]

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and at the goals as they would look from there."""
        of_kind = self._demos.columns["kind"] == goal.kind
        if not of_kind.any():
            raise PlanError(f"no demonstration is of a {goal.kind}; give some with polyfold demos")
        self._rows = np.flatnonzero(of_kind)
        self._goals = GoalPictures(goal, observation, self._segmenter.segment(observation))
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The action of the closest demonstration; None after the last fold."""
        if (wanted := self._goals.next()) is None:
            return None
        seen = self._segmenter.segment(observation)
        columns, rows = self._demos.columns, self._rows
        goals = columns["end"][rows] if self._goals.final else rows
        alike = _overlaps(self._goals.now(observation, seen)[1], self._demos.masks[rows])
        alike += _overlaps(wanted[1], unpacked(columns["goal_mask"][goals]))
        row = rows[int(np.argmax(alike))]
        arms = np.isfinite(columns["picks"][row][:, 0])
        picks = on_cloth(self._goals.window.to_pixels(columns["picks"][row][arms]), seen)
        limit = [observation.camera.width - 1.0, observation.camera.height - 1.0]
        places = np.clip(self._goals.window.to_pixels(columns["places"][row][arms]), 0.0, limit)
        return Decision(Action(picks, places), Subgoal(str(columns["text"][row])))


@lru_cache(maxsize=2)
def _read(path: Path, version: int) -> Demos:
    """Demonstrations, read once until they change."""
    try:
        return Demos.read(path)
    except ConfigError as error:
        raise ConfigError(f"nearest-demo: {error}") from error


def _version(path: Path) -> int:
    return path.stat().st_mtime_ns if path.exists() else 0


def _overlaps(mask: NDArray[np.bool_], others: NDArray[np.bool_]) -> Floats:
    """Intersection over union of a mask, shape (S, S), with others, shape (N, S, S)."""
    both = (others & mask).sum((1, 2))
    return both / np.maximum((others | mask).sum((1, 2)), 1)
