"""The training of all rows that learn heatmaps from demonstrations, with the pick error as it falls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field
from torch import Tensor

from polyfold_baselines.demos.store import Demos
from polyfold_baselines.learning.examples import Examples, make_examples
from polyfold_baselines.learning.learner import LearnConfig, Learner, learn
from polyfold_baselines.learning.networks import heatmaps
from polyfold_baselines.learning.networks.network import Network

MOST_TURN, MOST_SHIFT, MOST_SIZE = math.radians(12.0), 6.0, 0.08
"""Pictures are turned [rad], moved [px] and scaled by up to so much: no more than garments lie differently. They are
never mirrored, since a sentence or a side would then be wrong."""


class Row(Protocol):
    """A baseline that is trained so; its agent's class."""

    row: ClassVar[str]
    arms: ClassVar[int]
    guide: ClassVar[str]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The untrained network of what ``fit.json`` says."""
        ...


class FitConfig(LearnConfig):
    """What to learn, from what, for how long; it decides the weights."""

    most_error_mm: float = Field(default=15.0, gt=0, description="folds that ended farther from the ideal are left out")
    precision: Literal["float32", "bfloat16"] = Field(default="bfloat16", description="of training")


def fit(config: FitConfig, row: type[Row], out: Path, device: str = "auto", progress: bool = True) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        config: what to do.
        row: the baseline.
        out: folder for ``weights.safetensors``, ``checkpoint.safetensors`` and ``metrics.jsonl``.
        device: ``cpu``, ``cuda`` or ``auto``.
        progress: show a progress bar.

    Raises:
        ConfigError: if the folder holds another training or is in use, or the demonstrations teach nothing.
    """
    demos = Demos.read(config.demos).with_arms(row.row, row.arms)
    note = {**config.model_dump(exclude={"demos"}), "demos": demos.hash, "arms": demos.plan.arms}
    return learn(lambda: _Heatmaps(config, row, note, demos, device), note, out, progress)


class _Told:
    """Folds, and what tells a network which one is wanted: the goal's picture, or a sentence."""

    def __init__(self, examples: Examples, guide: str) -> None:
        from polyfold_baselines.learning.sentences import encoded

        self.examples = examples
        self._tokens = encoded(examples.texts) if guide == "sentence" else None

    def wanted(self, frames: Tensor, chosen: NDArray[np.int64]) -> Tensor:
        """For folds, shape (N,), of which these are the frames, shape (N, 2, 2, SIDE, SIDE)."""
        return frames[:, 1] if self._tokens is None else self._tokens[self.examples.sentences[chosen]]


class _Heatmaps(Learner):
    """A network of heatmaps while it learns."""

    network: Network

    def __init__(self, config: FitConfig, row: type[Row], note: Mapping[str, Any], demos: Demos, device: str) -> None:
        super().__init__(row.network(note), config, device)
        self._config = config
        learned, held = make_examples(demos, config.most_error_mm)
        self._learned, self._held = (_Told(examples, row.guide) for examples in (learned, held))

    def loss(self, rng: np.random.Generator) -> Tensor:
        """Of folds that are turned and moved."""
        chosen = rng.integers(len(self._learned.examples), size=self._config.batch)
        examples = self._learned.examples
        frames, points = _moved(examples.frames[chosen], torch.from_numpy(examples.points[chosen]), rng)
        wanted = self._learned.wanted(frames, chosen)
        with torch.autocast(self.device.type, torch.bfloat16, self._config.precision == "bfloat16"):
            return self.network.loss(frames[:, 0].to(self.device), wanted.to(self.device), points.to(self.device))

    def measure(self) -> dict[str, float]:
        """Loss and pick error on garments held out."""
        errors, losses = [], []
        self.network.eval()
        held = self._held.examples
        with torch.inference_mode():
            for part in np.array_split(np.arange(len(held)), math.ceil(len(held) / 64)):
                wanted = self._held.wanted(held.frames[part], part)
                now, wanted = held.frames[part, 0].to(self.device), wanted.to(self.device)
                points = held.points[part]
                losses.append(float(self.network.loss(now, wanted, torch.from_numpy(points).to(self.device))))
                picks, _ = self.network.read(self.network(now, wanted), held.masks[part])
                errors.append(heatmaps.pick_error(picks, points))
        return {"held_out_loss": float(np.mean(losses)), "pick_error_px": float(np.concatenate(errors).mean())}


def _moved(frames: Tensor, points: Tensor, rng: np.random.Generator) -> tuple[Tensor, Tensor]:
    """Frames and points turned, moved and scaled together, each fold by its own."""
    from torch.nn import functional

    count, times, channels, side, _ = frames.shape
    turn = torch.from_numpy(rng.uniform(-MOST_TURN, MOST_TURN, count).astype(np.float32))
    size = torch.from_numpy((1 + rng.uniform(-MOST_SIZE, MOST_SIZE, count)).astype(np.float32))
    shift = torch.from_numpy(rng.uniform(-MOST_SHIFT, MOST_SHIFT, (count, 2)).astype(np.float32))
    cosine, sine = torch.cos(turn), torch.sin(turn)
    turning = torch.stack([torch.stack([cosine, -sine], -1), torch.stack([sine, cosine], -1)], -2)
    middle = (side - 1) / 2
    there = (points - middle) @ (size[:, None, None] * turning).transpose(1, 2)[:, None] + middle + shift[:, None, None]
    # Where each pixel of the new picture comes from, in the coordinates from -1 to 1 that torch samples in.
    back = turning.transpose(1, 2) / size[:, None, None]
    offset = -(back @ (shift / (side / 2))[..., None])
    grid = functional.affine_grid(torch.cat([back, offset], -1), [count, 1, side, side], align_corners=False)
    moved = functional.grid_sample(frames.reshape(count, times * channels, side, side), grid, align_corners=False)
    return moved.reshape(frames.shape), there
