"""A network in training: one pass over the data, validation, and the checkpoint from which it goes on."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold_fgpnp.policies.networks import ValueNetwork
from polyfold_fgpnp.training.augmentation import augmented
from polyfold_fgpnp.training.config import TrainingConfig
from polyfold_fgpnp.training.examples import Examples
from polyfold_fgpnp.training.ranks import rank_correlation

GUARD_STEPS, LEAST_SPREAD = 300, 0.01
"""After so many steps, predictions must differ over the picks of a state by this, in standard deviations of labels."""

WARM_UP = 0.05
"""Share of the steps over which the learning rate rises; then it falls along a cosine."""

CLIP = 1.0
"""Largest norm of a step's gradient."""


class Learner:
    """A network in training. Order and augmentation follow from seed and epoch alone, so that it can be resumed."""

    def __init__(self, config: TrainingConfig, examples: Examples, device: torch.device) -> None:
        torch.manual_seed(config.seed)
        self._config, self._examples, self._device = config, examples, device
        labels = examples.labels[examples.valid]
        self.mean, self.deviation = float(labels.mean()), float(labels.std()) or 1.0
        self.network = ValueNetwork(config.network).to(  # pyright: ignore[reportCallIssue]  (torch has no stub for it)
            device, memory_format=torch.channels_last
        )
        self._optimizer = torch.optim.AdamW(
            self.network.parameters(), config.learning_rate, weight_decay=config.weight_decay
        )
        self._steps_per_epoch = math.ceil(len(examples) / config.batch)

    def epoch(self, number: int) -> float:
        """One pass over all states; returns the mean loss."""
        self.network.train()
        rng = np.random.default_rng([self._config.seed, number])
        order = rng.permutation(len(self._examples))
        losses = []
        for index, start in enumerate(range(0, len(order), self._config.batch)):
            step = number * self._steps_per_epoch + index
            some = augmented(
                self._examples.chosen(order[start : start + self._config.batch]), self._config.network, rng
            )
            losses.append(self._step(step, some))
        return float(np.mean(losses))

    def _step(self, step: int, some: Examples) -> float:
        for group in self._optimizer.param_groups:
            group["lr"] = self._config.learning_rate * self._rate(step)
        predicted, wanted, valid = self._predict(some)
        loss = _loss(predicted - wanted[..., None], valid, self._config.state_weight)
        self._optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), CLIP)
        self._optimizer.step()
        if step == GUARD_STEPS:
            _refuse_collapse(predicted.detach(), valid)
        return float(loss.detach())

    def _rate(self, step: int) -> float:
        done = step / max(1, self._config.epochs * self._steps_per_epoch)
        return min(1.0, (done + 1e-3) / WARM_UP) if done < WARM_UP else 0.5 + 0.5 * math.cos(math.pi * done)

    def _predict(self, some: Examples) -> tuple[Tensor, Tensor, Tensor]:
        """Predicted values, shape (B, K, V), standardised labels, shape (B, K), and which are valid."""
        images = self._tensor(some.images).to(memory_format=torch.channels_last).float() / 255
        low = self._config.precision == "bfloat16"
        with torch.autocast(self._device.type, torch.bfloat16, enabled=low):
            maps = self.network(images, self._tensor(some.lines))
        predicted = self.network.values(maps.float(), self._tensor(some.points), self._tensor(some.geometry))
        wanted = (self._tensor(some.labels) - self.mean) / self.deviation
        return predicted, wanted, self._tensor(some.valid)

    def _tensor(self, values: NDArray[Any]) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(values)).to(self._device)

    def validate(self, examples: Examples) -> dict[str, float]:
        """Loss, and the rank correlation of predictions and labels over a state's picks, the median over states."""
        self.network.eval()
        errors, correlations = [], []
        with torch.inference_mode():
            for start in range(0, len(examples), self._config.batch):
                some = examples.chosen(np.arange(start, min(start + self._config.batch, len(examples))))
                predicted, wanted, valid = (found.cpu().numpy() for found in self._predict(some))
                errors.append(((predicted - wanted[..., None]) ** 2).mean(-1)[valid])
                correlations += [
                    rank_correlation(p.mean(-1)[v], w[v]) for p, w, v in zip(predicted, wanted, valid, strict=True)
                ]
        return {
            "validation_loss": float(np.concatenate(errors).mean()),
            "rank_correlation": float(np.nanmedian(correlations)) if np.isfinite(correlations).any() else math.nan,
        }

    def save(self, path: Path, epoch: int) -> None:
        """Write network and optimiser, whole or not at all."""
        from safetensors.torch import save_file

        tensors = {f"network.{name}": tensor for name, tensor in self.network.state_dict().items()}
        for index, state in self._optimizer.state_dict()["state"].items():
            tensors |= {f"optimizer.{index}.{name}": tensor for name, tensor in state.items()}
        tensors = {name: tensor.cpu().contiguous() for name, tensor in tensors.items()}
        part = path.with_suffix(".part")
        save_file(tensors, part, {"epoch": str(epoch), "sha256": _digest(tensors)})
        part.replace(path)

    def resume(self, path: Path) -> int:
        """Go on from a checkpoint if there is one; returns how many epochs are done."""
        from safetensors import SafetensorError, safe_open

        if not path.exists():
            return 0
        try:
            with safe_open(path, "pt") as stream:
                epoch, digest = int(stream.metadata()["epoch"]), stream.metadata()["sha256"]
                tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118
            if digest != _digest(tensors):
                raise ValueError("its numbers are not those that were written")
        except (SafetensorError, KeyError, TypeError, ValueError) as error:
            raise ConfigError(f"{path} is damaged ({error}); remove it to train from the beginning") from error
        self.network.load_state_dict(_under("network.", tensors))
        state: dict[int, dict[str, Tensor]] = {}
        for name, tensor in _under("optimizer.", tensors).items():
            index, _, key = name.partition(".")
            state.setdefault(int(index), {})[key] = tensor
        self._optimizer.load_state_dict({**self._optimizer.state_dict(), "state": state})
        return epoch


def _loss(errors: Tensor, valid: Tensor, state_weight: float) -> Tensor:
    """Mean square of the errors of valid trials, shape (B, K, V); what a state's trials share is weighted."""
    there = valid[..., None].float()
    shared = (errors * there).sum(1, keepdim=True) / there.sum(1, keepdim=True)
    squares = (errors - shared).square() + state_weight * shared.square()
    return (squares.mean(-1) * valid).sum() / valid.sum()


def _digest(tensors: Mapping[str, Tensor]) -> str:
    """SHA-256 of all names and numbers: a flipped bit would train on as if nothing were."""
    digest = hashlib.sha256()
    for name in sorted(tensors):
        digest.update(name.encode())
        digest.update(tensors[name].numpy().tobytes())
    return digest.hexdigest()


def _under(prefix: str, tensors: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}


def _refuse_collapse(predicted: Tensor, valid: Tensor) -> None:
    spread = [p[v].std(0).mean() for p, v in zip(predicted, valid, strict=True) if v.sum() > 1]
    if spread and float(torch.stack(spread).mean()) < LEAST_SPREAD:
        raise ConfigError(
            f"after {GUARD_STEPS} steps the network predicts the same everywhere, so it has collapsed; "
            "lower learning_rate, or try another seed"
        )
