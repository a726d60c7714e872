"""What all agents share that imitate demonstrations through heatmaps, told what to do by pictures or by sentences."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError
from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal
from polyfold_baselines.agents.goals import GoalPictures, InTurn, seen_through
from polyfold_baselines.demos.window import Window

if TYPE_CHECKING:
    from torch import Tensor

    from polyfold_baselines.learning.networks.network import Network
    from polyfold_baselines.learning.weights import Weights

Floats = NDArray[np.float64]


class ImitationConfig(BaseModel):
    """Parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    weights: Path | None = Field(
        default=None, description="file of `polyfold fit`; by default what comes with the package"
    )


class Imitation(ABC):
    """Sees the cloth as depth, is told what the next fold should be, and picks and places where heatmaps are highest.

    With steps guidance it folds once for each subgoal; with the final goal alone as often as the task takes.
    """

    row: ClassVar[str]
    arms: ClassVar[int]
    guide: ClassVar[str]
    requires: ClassVar[frozenset[str]]
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)
    Config: ClassVar[type[ImitationConfig]] = ImitationConfig
    _window: Window

    def __init__(self, config: ImitationConfig, segmenter: Segmenter) -> None:
        self._weights = read_weights(type(self), config)
        self._segmenter = segmenter

    @classmethod
    def files_read(cls, config: ImitationConfig) -> list[Path]:
        """The file of its weights."""
        return [weights_file(cls, config)]

    @classmethod
    @abstractmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The untrained network of what ``fit.json`` says."""

    @abstractmethod
    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and note what each fold should lead to."""

    @abstractmethod
    def _wanted(self) -> tuple[Tensor, Subgoal | None] | None:
        """What the next fold should lead to, as the network takes it, and in words if in any; None after the last."""

    def decide(self, observation: Observation) -> Decision | None:
        """The next fold; None after the last."""
        import torch

        from polyfold_baselines.learning.examples import as_frame
        from polyfold_baselines.learning.networks import heatmaps

        if (wanted := self._wanted()) is None:
            return None
        now = seen_through(self._window, observation, self._segmenter.segment(observation))
        with torch.inference_mode():
            logits = self._weights.network(as_frame(*now)[None], wanted[0][None])
        picks, places = self._weights.network.read(logits, now[1][None])
        return Decision(self._action(*heatmaps.merged(picks[0], places[0]), observation), wanted[1])

    def _action(self, picks: Floats, places: Floats, observation: Observation) -> Action:
        limit = [observation.camera.width - 1.0, observation.camera.height - 1.0]
        return Action(*(np.clip(self._window.to_pixels(points), 0.0, limit) for points in (picks, places)))


class PictureImitation(Imitation):
    """Is told by a picture, in depth, of what the cloth should look like."""

    guide: ClassVar[str] = "picture"
    requires: ClassVar[frozenset[str]] = frozenset({"subgoal_depths", "fold_count"})

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and at the goals as they would look from there."""
        self._goals = GoalPictures(goal, observation, self._segmenter.segment(observation))
        self._window = self._goals.window
        return ()

    def _wanted(self) -> tuple[Tensor, Subgoal | None] | None:
        from polyfold_baselines.learning.examples import as_frame

        view = self._goals.next()
        return None if view is None else (as_frame(*view), None)


class SentenceImitation(Imitation):
    """Is told by a sentence."""

    guide: ClassVar[str] = "sentence"
    requires: ClassVar[frozenset[str]] = frozenset({"subgoal_texts", "fold_count"})

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and hear what to do."""
        self._window = Window.around(self._segmenter.segment(observation))
        self._sentences = InTurn(goal.subgoal_texts or (), goal.fold_count)
        return ()

    def _wanted(self) -> tuple[Tensor, Subgoal | None] | None:
        from polyfold_baselines.learning.sentences import encoded

        text = self._sentences.next()
        return None if text is None else (encoded([text])[0], Subgoal(text))


class Learned(Protocol):
    """An agent's class whose network was trained by ``polyfold fit``."""

    row: ClassVar[str]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Any:
        """The untrained network of what ``fit.json`` says."""
        ...


def weights_file(cls: type[Learned], config: ImitationConfig) -> Path:
    """The file that is named, else the row's own that comes with the package. Raises ConfigError if none does."""
    if config.weights is not None:
        return config.weights
    shipped = Path(__file__).parents[2] / "weights" / f"{cls.row}.safetensors"
    if not shipped.is_file():
        raise ConfigError(
            f"no weights of {cls.row} come with the package; make them with 'polyfold fit {cls.row}', and name their "
            "file: weights=FILE"
        )
    return shipped


def read_weights(cls: type[Learned], config: ImitationConfig) -> Weights:
    """The weights of a file, read once until it changes. Raises ConfigError if they are not this row's."""
    path = weights_file(cls, config)
    stamp = (path.stat().st_mtime_ns, path.stat().st_size) if path.is_file() else (0, 0)
    return _read(cls, path.resolve(), stamp)


@lru_cache(maxsize=4)
def _read(cls: type[Learned], path: Path, stamp: tuple[int, int]) -> Weights:
    from polyfold_baselines.learning.weights import load

    return load(path, cls.row, cls.network)
