"""How every row learns from a folder of demonstrations: a budget, a rate that rises and falls, looks, checkpoints."""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict, Field
from torch import Tensor, nn

from polyfold.logs import JsonLines
from polyfold_baselines.learning import checkpoints
from polyfold_baselines.learning.checkpoints import training_in
from polyfold_baselines.learning.weights import Weights, save

LOOK = 250
"""Steps between two looks at what is held out, each with a checkpoint."""
WARM = 200


class LearnConfig(BaseModel):
    """What to learn, from what, for how long; it decides the weights."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    row: str = Field(description="which baseline")
    demos: str = Field(description="folder of `polyfold demos`")
    passes: int = Field(default=100_000, ge=1, description="folds looked at, each as often as it comes")
    batch: int = Field(default=32, ge=1, description="folds in a step")
    learning_rate: float = Field(default=5e-4, gt=0, description="largest, of AdamW")
    weight_decay: float = Field(default=0.05, ge=0, description="of AdamW")
    width: int = Field(default=128, ge=16, description="of the network")
    depth: int = Field(default=4, ge=1, description="of the network")
    seed: int = Field(default=0, ge=0, description="of weights, order and augmentation")


@dataclass
class _Progress:
    """How far a training has come."""

    step: int = 0
    minutes: float = 0.0


class Learner(ABC):
    """A network while it learns.

    Args:
        network: untrained.
        config: what to do.
        device: ``cpu``, ``cuda`` or ``auto``.

    Attributes:
        last: what was measured last.
    """

    def __init__(self, network: nn.Module, config: LearnConfig, device: str) -> None:
        self._budget = config
        self.device = torch.device(("cuda" if torch.cuda.is_available() else "cpu") if device == "auto" else device)
        self.network = network.to(self.device)
        self._optimizer = torch.optim.AdamW(
            self.network.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay
        )
        self.progress = _Progress()
        self.last: dict[str, float] = {}

    @abstractmethod
    def loss(self, rng: np.random.Generator) -> Tensor:
        """What is to be less, of a batch that is drawn."""

    @abstractmethod
    def measure(self) -> dict[str, float]:
        """What is found on garments held out."""

    @property
    def steps(self) -> int:
        """Of the whole training."""
        return math.ceil(self._budget.passes / self._budget.batch)

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
                    passes = self.progress.step * self._budget.batch
                    metrics.append({"passes": passes, "minutes": round(self.progress.minutes, 2), **self.last})
                    self._save(checkpoint)
                    bar.set_postfix({name: f"{value:.2f}" for name, value in self.last.items()}, refresh=False)

    def _step(self, number: int) -> float:
        for group in self._optimizer.param_groups:
            group["lr"] = self._budget.learning_rate * _rate(number, self.steps)
        self.network.train()
        found = self.loss(np.random.default_rng([self._budget.seed, number]))
        self._optimizer.zero_grad(set_to_none=True)
        found.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self._optimizer.step()
        return float(found.detach())

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
                    key: stored[f"o/{name}/{key}"].to("cpu" if key == "step" else self.device) for key in keys
                }

    def _save(self, path: Path) -> None:
        told = {"step": self.progress.step, "minutes": self.progress.minutes, "last": self.last}
        tensors: dict[str, Tensor] = {f"n/{name}": value for name, value in self.network.state_dict().items()}
        for name, parameter in self.network.named_parameters():
            for key, value in self._optimizer.state.get(parameter, {}).items():
                tensors[f"o/{name}/{key}"] = torch.as_tensor(value)
        checkpoints.write(path, tensors, told)


def learn(make: Callable[[], Learner], note: Mapping[str, Any], out: Path, progress: bool) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        make: the learner, once the folder is ours.
        note: what the training is, ``row`` and ``seed`` among it.
        out: folder for ``weights.safetensors``, ``checkpoint.safetensors`` and ``metrics.jsonl``.
        progress: show a progress bar.

    Raises:
        ConfigError: if the folder holds another training or is in use.
    """
    with training_in(out, note):
        torch.manual_seed(note["seed"])
        learner = make()
        learner.resume(out / "checkpoint.safetensors")
        learner.run(JsonLines(out / "metrics.jsonl"), out / "checkpoint.safetensors", progress)
        save(out / "weights.safetensors", Weights(learner.network, note, learner.progress.minutes, learner.last))
    return out / "weights.safetensors"


def _rate(step: int, steps: int) -> float:
    """Share of the largest learning rate: it rises, then falls along a cosine."""
    warm = min(WARM, max(1, steps // 10))
    return (step + 1) / warm if step < warm else 0.5 * (1 + math.cos(math.pi * (step - warm) / max(1, steps - warm)))
