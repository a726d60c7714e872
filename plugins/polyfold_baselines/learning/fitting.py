"""The one training of all rows that learn from demonstrations: a budget, checkpoints, the pick error as it falls."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field
from torch import Tensor, nn

from polyfold.logs import JsonLines
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.learning import checkpoints
from polyfold_baselines.learning.checkpoints import training_in
from polyfold_baselines.learning.examples import Examples, make_examples
from polyfold_baselines.learning.networks import heatmaps
from polyfold_baselines.learning.networks.network import Network
from polyfold_baselines.learning.weights import Weights, save

LOOK = 250
"""Steps between two looks at what is held out, each with a checkpoint."""
WARM = 200
MOST_TURN, MOST_SHIFT, MOST_SIZE = math.radians(12.0), 6.0, 0.08
"""Pictures are turned [rad], moved [px] and scaled by up to so much: no more than garments lie differently. They are
never mirrored, since a sentence or a side would then be wrong."""


class Row(Protocol):
    """A baseline that is trained so; its agent's class."""

    row: ClassVar[str]
    guide: ClassVar[str]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The untrained network of what ``fit.json`` says."""
        ...


class FitConfig(BaseModel):
    """What to learn, from what, for how long; it decides the weights."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    row: str = Field(description="which baseline")
    demos: str = Field(description="folder of `polyfold demos`")
    passes: int = Field(default=100_000, ge=1, description="folds looked at, each as often as it comes")
    batch: int = Field(default=32, ge=1, description="folds in a step")
    learning_rate: float = Field(default=5e-4, gt=0, description="largest, of AdamW")
    weight_decay: float = Field(default=0.05, ge=0, description="of AdamW")
    most_error_mm: float = Field(default=15.0, gt=0, description="folds that ended farther from the ideal are left out")
    width: int = Field(default=128, ge=16, description="of the network")
    depth: int = Field(default=4, ge=1, description="of the network")
    precision: Literal["float32", "bfloat16"] = Field(default="bfloat16", description="of training")
    seed: int = Field(default=0, ge=0, description="of weights, order and augmentation")


@dataclass
class _Progress:
    """How far a training has come."""

    step: int = 0
    minutes: float = 0.0


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
    torch.manual_seed(config.seed)
    demos = Demos.read(config.demos)
    note = {**config.model_dump(exclude={"demos"}), "demos": demos.hash, "arms": demos.plan.arms}
    with training_in(out, note):
        learner = _Learner(config, row, note, demos, device)
        learner.resume(out / "checkpoint.safetensors")
        learner.run(JsonLines(out / "metrics.jsonl"), out / "checkpoint.safetensors", progress)
        save(out / "weights.safetensors", Weights(learner.network, note, learner.progress.minutes, learner.last))
    return out / "weights.safetensors"


class _Told:
    """Folds, and what tells a network which one is wanted: the goal's picture, or a sentence."""

    def __init__(self, examples: Examples, guide: str) -> None:
        from polyfold_baselines.learning.sentences import encoded

        self.examples = examples
        self._tokens = encoded(examples.texts) if guide == "sentence" else None

    def wanted(self, frames: Tensor, chosen: NDArray[np.int64]) -> Tensor:
        """For folds, shape (N,), of which these are the frames, shape (N, 2, 2, SIDE, SIDE)."""
        return frames[:, 1] if self._tokens is None else self._tokens[self.examples.sentences[chosen]]


class _Learner:
    """A network while it learns."""

    def __init__(self, config: FitConfig, row: type[Row], note: Mapping[str, Any], demos: Demos, device: str) -> None:
        self._config = config
        self._device = torch.device(("cuda" if torch.cuda.is_available() else "cpu") if device == "auto" else device)
        self.network = row.network(note).to(self._device)
        learned, held = make_examples(demos, config.most_error_mm)
        self._learned, self._held = (_Told(examples, row.guide) for examples in (learned, held))
        self._optimizer = torch.optim.AdamW(
            self.network.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay
        )
        self.progress = _Progress()
        self.last: dict[str, float] = {}

    @property
    def steps(self) -> int:
        """Of the whole training."""
        return math.ceil(self._config.passes / self._config.batch)

    def run(self, metrics: JsonLines, checkpoint: Path, progress: bool) -> None:
        """The steps that are not done yet."""
        from tqdm.auto import tqdm

        begun, before = time.monotonic(), self.progress.minutes
        losses: list[float] = []
        with tqdm(total=self.steps, initial=self.progress.step, unit="step", disable=not progress) as bar:
            while self.progress.step < self.steps:
                losses.append(self._step(self.progress.step))
                self.progress.step += 1
                bar.update()
                if self.progress.step % LOOK == 0 or self.progress.step == self.steps:
                    self.progress.minutes = before + (time.monotonic() - begun) / 60
                    self.last = {"loss": float(np.mean(losses)), **self.measure()}
                    losses.clear()
                    passes = self.progress.step * self._config.batch
                    metrics.append({"passes": passes, "minutes": round(self.progress.minutes, 2), **self.last})
                    self._save(checkpoint)
                    bar.set_postfix({name: f"{value:.2f}" for name, value in self.last.items()}, refresh=False)

    def _step(self, number: int) -> float:
        rng = np.random.default_rng([self._config.seed, number])
        chosen = rng.integers(len(self._learned.examples), size=self._config.batch)
        examples = self._learned.examples
        frames, points = _moved(examples.frames[chosen], torch.from_numpy(examples.points[chosen]), rng)
        wanted = self._learned.wanted(frames, chosen)
        for group in self._optimizer.param_groups:
            group["lr"] = self._config.learning_rate * _rate(number, self.steps)
        self.network.train()
        with torch.autocast(self._device.type, torch.bfloat16, self._config.precision == "bfloat16"):
            found = self.network.loss(frames[:, 0].to(self._device), wanted.to(self._device), points.to(self._device))
        self._optimizer.zero_grad(set_to_none=True)
        found.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self._optimizer.step()
        return float(found.detach())

    def measure(self) -> dict[str, float]:
        """Loss and pick error on garments held out."""
        errors, losses = [], []
        self.network.eval()
        held = self._held.examples
        with torch.inference_mode():
            for part in np.array_split(np.arange(len(held)), math.ceil(len(held) / 64)):
                wanted = self._held.wanted(held.frames[part], part)
                now, wanted = held.frames[part, 0].to(self._device), wanted.to(self._device)
                points = held.points[part]
                losses.append(float(self.network.loss(now, wanted, torch.from_numpy(points).to(self._device))))
                picks, _ = self.network.read(self.network(now, wanted), held.masks[part])
                errors.append(heatmaps.pick_error(picks, points))
        return {"held_out_loss": float(np.mean(losses)), "pick_error_px": float(np.concatenate(errors).mean())}

    def resume(self, path: Path) -> None:
        """Go on where a checkpoint is, if there is one."""
        if (found := checkpoints.read(path)) is None:
            return
        stored, told = found
        self.progress, self.last = _Progress(told["step"], told["minutes"]), told["last"]
        self.network.load_state_dict({name[2:]: value for name, value in stored.items() if name.startswith("n/")})
        for name, parameter in self.network.named_parameters():
            keys = [key for key in ("exp_avg", "exp_avg_sq", "step") if f"o/{name}/{key}" in stored]
            if keys:
                self._optimizer.state[parameter] = {
                    key: stored[f"o/{name}/{key}"].to("cpu" if key == "step" else self._device) for key in keys
                }

    def _save(self, path: Path) -> None:
        told = {"step": self.progress.step, "minutes": self.progress.minutes, "last": self.last}
        tensors: dict[str, Tensor] = {f"n/{name}": value for name, value in self.network.state_dict().items()}
        for name, parameter in self.network.named_parameters():
            for key, value in self._optimizer.state.get(parameter, {}).items():
                tensors[f"o/{name}/{key}"] = torch.as_tensor(value)
        checkpoints.write(path, tensors, told)


def _rate(step: int, steps: int) -> float:
    """Share of the largest learning rate: it rises, then falls along a cosine."""
    warm = min(WARM, max(1, steps // 10))
    return (step + 1) / warm if step < warm else 0.5 * (1 + math.cos(math.pi * (step - warm) / max(1, steps - warm)))


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
