"""What all agents share that imitate demonstrations, by pictures of their goals, through heatmaps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal
from polyfold_baselines.agents.goals import GoalPictures

if TYPE_CHECKING:
    from torch import nn

    from polyfold_baselines.learning.weights import Weights

Floats = NDArray[np.float64]


class ImitationConfig(BaseModel):
    """Parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    weights: Path = Field(description="file of `polyfold fit`")


class Imitation(ABC):
    """Sees the cloth and its next goal as depth, and picks and places where a network's heatmaps are highest.

    With steps guidance it folds once towards each subgoal; with the final goal alone as often as the task takes.
    """

    row: ClassVar[str]
    requires: ClassVar[frozenset[str]] = frozenset({"subgoal_depths", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)
    Config: ClassVar[type[ImitationConfig]] = ImitationConfig

    def __init__(self, config: ImitationConfig, segmenter: Segmenter) -> None:
        self._weights = _read(type(self), config.weights.resolve(), _version(config.weights))
        self._segmenter = segmenter

    @classmethod
    def files_read(cls, config: ImitationConfig) -> list[Path]:
        """The file of its weights."""
        return [config.weights]

    @classmethod
    @abstractmethod
    def network(cls, config: Mapping[str, Any]) -> nn.Module:
        """The untrained network of what ``fit.json`` says."""

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and at the goals as they would look from there."""
        self._goals = GoalPictures(goal, observation, self._segmenter.segment(observation))
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The next fold; None after the last."""
        import torch

        from polyfold_baselines.learning import heatmaps
        from polyfold_baselines.learning.examples import as_frame

        if (wanted := self._goals.next()) is None:
            return None
        now = self._goals.now(observation, self._segmenter.segment(observation))
        frames = torch.stack([as_frame(*now), as_frame(*wanted)])[None]
        with torch.inference_mode():
            logits = self._weights.network(frames)
        picks, places = heatmaps.read(logits, now[1][None], int(self._weights.config["arms"]))
        return Decision(self._action(*heatmaps.merged(picks[0], places[0]), observation))

    def _action(self, picks: Floats, places: Floats, observation: Observation) -> Action:
        limit = [observation.camera.width - 1.0, observation.camera.height - 1.0]
        return Action(*(np.clip(self._goals.window.to_pixels(points), 0.0, limit) for points in (picks, places)))


def _version(path: Path) -> tuple[int, int]:
    return (path.stat().st_mtime_ns, path.stat().st_size) if path.is_file() else (0, 0)


@lru_cache(maxsize=4)
def _read(cls: type[Imitation], path: Path, version: tuple[int, int]) -> Weights:
    """The weights of a file, read once until it changes."""
    from polyfold_baselines.learning.weights import load

    return load(path, cls.row, cls.network)
