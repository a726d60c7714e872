"""A reader in training: its network, its optimiser, the average of its weights, and the checkpoint to go on from."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from polyfold.errors import ConfigError
from polyfold_offline.training.batches import Batches
from polyfold_offline.training.network import ReaderNetwork


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to learn.

    Attributes:
        steps: batches.
        size: sentences in a batch.
        rate: learning rate of the encoder.
        decoder_rate: of the decoder, which begins further from its end.
        seed: of the decoder's first weights, of all batches and of dropout.
        every: steps between checkpoints.
    """

    steps: int = 6000
    size: int = 32
    rate: float = 1e-4
    decoder_rate: float = 3e-4
    seed: int = 0
    every: int = 200

    @classmethod
    def going_on(cls, steps: int, seed: int) -> Schedule:
        """For a reader that was trained before: slower, so that it keeps what it knows."""
        return cls(steps=steps, seed=seed, rate=cls.rate / 3, decoder_rate=cls.decoder_rate / 3)


class Learner:
    """A network, its optimiser, and the average of its weights over the last steps."""

    def __init__(self, batches: Batches, network: ReaderNetwork, plan: Schedule) -> None:
        self.network = network
        self.network.words.requires_grad_(False)
        self.average = {name: tensor.clone() for name, tensor in self.network.state_dict().items()}
        self._batches, self._plan = batches, plan
        named = dict(self.network.named_parameters())
        given = [p for name, p in named.items() if name.startswith(("places", "embedded", "encoder"))]
        new = [p for name, p in named.items() if name.startswith(("tokens", "steps", "decoder", "spell"))]
        groups = [{"params": given, "rate": plan.rate}, {"params": new, "rate": plan.decoder_rate}]
        self.optimiser = torch.optim.AdamW(groups, lr=plan.rate, weight_decay=0.01, fused=True)
        self._moving = [(name, p) for name, p in named.items() if p.requires_grad]
        self.step = 0

    def learn(self) -> float:
        """Make one step and return its mean loss a token."""
        for group in self.optimiser.param_groups:
            group["lr"] = group["rate"] * _pace(self.step, self._plan.steps)
        torch.manual_seed(self._plan.seed * 1_000_003 + self.step)
        batch = self._batches(self.step)
        self.network.train()
        said = self.network(batch).gather(-1, batch.tokens[:, 1:, None])[..., 0]
        loss = -said[batch.counted].mean()
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self.optimiser.step()
        self.step += 1
        keep = min(_AVERAGED, self.step / (self.step + 10))
        with torch.no_grad():
            for name, parameter in self._moving:
                self.average[name].lerp_(parameter, 1 - keep)
        return float(loss.detach())

    def save(self, path: Path) -> None:
        """Write all that training needs to go on."""
        from safetensors.torch import save_file

        told = {f"network.{name}": tensor for name, tensor in self.network.state_dict().items()}
        told |= {f"average.{name}": tensor for name, tensor in self.average.items()}
        for number, state in self.optimiser.state_dict()["state"].items():
            told |= {f"optimiser.{number}.{name}": tensor for name, tensor in state.items()}
        told = {name: tensor.contiguous() for name, tensor in told.items()}
        part = path.with_suffix(".part")
        save_file(told, part, {"step": str(self.step), "sha256": digest_of(told)})
        part.replace(path)

    def resume(self, path: Path) -> None:
        """Go on from a checkpoint, if there is one."""
        from safetensors import SafetensorError, safe_open

        if not path.exists():
            return
        state: dict[int, dict[str, Any]] = {}
        try:
            with safe_open(path, "pt") as file:
                step, digest = int(file.metadata()["step"]), file.metadata()["sha256"]
                told = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - it is no dictionary
            if digest != digest_of(told):
                raise ValueError("its numbers are not those that were written")
        except (SafetensorError, KeyError, TypeError, ValueError) as error:
            raise ConfigError(f"{path} is damaged ({error}); remove it to learn from the beginning") from error
        self.step = step
        self.network.load_state_dict(_under("network.", told))
        self.average = _under("average.", told)
        for name, tensor in told.items():
            if name.startswith("optimiser."):
                _, number, what = name.split(".", 2)
                state.setdefault(int(number), {})[what] = tensor
        self.optimiser.load_state_dict({"state": state, "param_groups": self.optimiser.state_dict()["param_groups"]})


_AVERAGED = 0.998
"""Share of the average that a step leaves."""


def digest_of(tensors: Mapping[str, torch.Tensor]) -> str:
    """SHA-256 of all names and numbers."""
    digest = hashlib.sha256()
    for name in sorted(tensors):
        digest.update(name.encode())
        digest.update(tensors[name].numpy().tobytes())
    return digest.hexdigest()


def _under(prefix: str, tensors: Mapping[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}


def _pace(step: int, steps: int) -> float:
    """The share of the learning rate: up in the first part, then down along a cosine."""
    rise = max(1, steps // 25)
    if step < rise:
        return (step + 1) / rise
    return 0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * (step - rise) / max(1, steps - rise)))
