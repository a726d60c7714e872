"""Training a value network: resumable, on a processor or a GPU, with a guard against collapse."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.policies.networks import NetworkConfig, ValueNetwork
from polyfold_fgpnp.policies.weights import Provenance, save_weights
from polyfold_fgpnp.training.examples import Examples, make_examples
from polyfold_fgpnp.training.logs import Logs
from polyfold_fgpnp.training.ranks import rank_correlation

GUARD_STEPS, LEAST_SPREAD = 300, 0.01
"""After so many steps, predictions must differ over the picks of a state by this, in standard deviations of labels."""

WARM_UP = 0.05
"""Share of the steps over which the learning rate rises; then it falls along a cosine."""

CLIP = 1.0


class TrainingConfig(BaseModel):
    """What to train, from what and how; read from TOML.

    Snapshots are the weights after some epochs, for learning curves. They come from one training whose learning rate
    falls along a cosine, so early ones are noisier than the end of a training of that length. They change nothing else:
    neither the final weights, nor what these say they were trained from, nor which folder a training belongs to.
    A training that is gone on with has no snapshots of epochs that were over before they were asked for.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    data: tuple[str, ...] = Field(min_length=1, description="data sets of `polyfold collect`")
    network: NetworkConfig = Field(default_factory=NetworkConfig)
    folds: int | None = Field(default=None, ge=1, description="use the first so many folds of each data set")
    reward: Literal["contour", "particles", "both"] = Field(default="particles", description="what counts as good")
    scale: Literal["linear", "log"] = Field(default="log", description="how rewards become labels")
    state_weight: float = Field(
        default=1.0, ge=0, description="weight of the error that all picks of a state share; 1: MSE"
    )
    epochs: int = Field(default=60, ge=1, description="passes over all states")
    snapshots: tuple[int, ...] = Field(default=(), description="epochs after which the weights so far are kept as well")
    batch: int = Field(default=32, ge=1, description="states in a step")
    learning_rate: float = Field(default=2e-3, gt=0, description="largest, of AdamW")
    weight_decay: float = Field(default=1e-2, ge=0, description="of AdamW")
    held_out: float = Field(default=0.1, gt=0, lt=1, description="share of the garments kept for validation")
    precision: Literal["float32", "bfloat16"] = Field(default="float32", description="of the convolutions in training")
    seed: int = Field(default=0, ge=0, description="of weights, order and augmentation")

    @model_validator(mode="after")
    def _snapshots_are_epochs(self) -> TrainingConfig:
        for epoch in self.snapshots:
            if not 1 <= epoch <= self.epochs:
                raise ValueError(f"snapshots has {epoch}, and epochs go from 1 to {self.epochs}")
        return self

    def plain(self) -> dict[str, Any]:
        """What decides the weights, as plain data."""
        return self.model_dump(mode="json", exclude={"snapshots"})


def snapshot_name(epoch: int) -> str:
    """File of the weights after an epoch, in the folder of the training."""
    return f"weights-{epoch:04d}.safetensors"


def train(config: TrainingConfig, out: str | Path, device: str = "auto", progress: bool = True) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        config: what to do.
        out: folder for ``weights.safetensors``, snapshots such as ``weights-0020.safetensors``,
            ``checkpoint.safetensors``, ``metrics.jsonl`` and TensorBoard's log.
        device: ``cpu``, ``cuda`` or ``auto``.
        progress: show a progress bar.

    Raises:
        ConfigError: if the folder holds another training, data or the device is missing, or the network has collapsed.
    """
    from tqdm import tqdm

    out = Path(out)
    target = _device(device)
    sets = [load_dataset(path) for path in config.data]
    hashes = tuple(data.description["hash"] for data in sets)
    note = json.dumps({"config": config.plain(), "data": hashes}, indent=2) + "\n"
    _refuse_another(out, note)
    examples = make_examples(
        sets, config.network.variant, config.network.frame, config.reward, config.scale, config.folds
    )
    learned, validation = _split(examples, config.held_out)
    run = _Run(config, learned, target)
    out.mkdir(parents=True, exist_ok=True)
    (out / "training.json").write_text(note, "utf-8")
    first = run.resume(out / "checkpoint.safetensors")
    provenance = Provenance(config.plain(), hashes, run.mean, run.deviation)
    with Logs(out, first) as logs, tqdm(total=config.epochs, initial=first, unit="epoch", disable=not progress) as bar:
        for epoch in range(first, config.epochs):
            loss = run.epoch(epoch)
            found = {"loss": loss, **run.validate(validation)}
            logs.write(epoch + 1, found)
            if epoch + 1 in config.snapshots:  # before the checkpoint: a run killed between the two writes it again
                so_far = replace(provenance, config={**provenance.config, "epochs_done": epoch + 1})
                save_weights(out / snapshot_name(epoch + 1), run.network, so_far)
            run.save(out / "checkpoint.safetensors", epoch + 1)
            bar.set_postfix({name: f"{value:.3f}" for name, value in found.items()}, refresh=False)
            bar.update()
    save_weights(out / "weights.safetensors", run.network, provenance)
    return out / "weights.safetensors"


def _device(name: str) -> torch.device:
    if name == "cuda" and not torch.cuda.is_available():
        raise ConfigError("PyTorch finds no GPU here; train with --device cpu, or install PyTorch with CUDA")
    return torch.device(("cuda" if torch.cuda.is_available() else "cpu") if name == "auto" else name)


def _refuse_another(out: Path, wanted: str) -> None:
    """Refuse a folder whose note says that it holds another training."""
    note = out / "training.json"
    if note.exists() and note.read_text("utf-8") != wanted:
        raise ConfigError(f"{out} holds a training with another configuration or other data; choose another folder")


def _split(examples: Examples, held_out: float) -> tuple[Examples, Examples]:
    """Training and validation states; a garment is in one of the two."""
    garments = np.unique(examples.garments)
    if len(garments) < 2:
        raise ConfigError("the data holds fewer than two garments, so none can be held out; collect from more")
    kept = garments[: max(1, min(len(garments) - 1, round(len(garments) * (1 - held_out))))]
    learned = np.isin(examples.garments, kept)
    return examples.chosen(learned), examples.chosen(~learned)


class _Run:
    """A network in training. Order and augmentation follow from seed and epoch alone, so that it can be resumed."""

    def __init__(self, config: TrainingConfig, examples: Examples, device: torch.device) -> None:
        torch.manual_seed(config.seed)
        self._config, self._examples, self._device = config, examples, device
        labels = examples.labels[examples.valid]
        self.mean, self.deviation = float(labels.mean()), float(labels.std()) or 1.0
        self.network = ValueNetwork(config.network).to(device, memory_format=torch.channels_last)
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
        part = path.with_suffix(".part")
        save_file({name: tensor.cpu().contiguous() for name, tensor in tensors.items()}, part, {"epoch": str(epoch)})
        part.replace(path)

    def resume(self, path: Path) -> int:
        """Go on from a checkpoint if there is one; returns how many epochs are done."""
        from safetensors import safe_open

        if not path.exists():
            return 0
        with safe_open(path, "pt") as stream:
            epoch = int(stream.metadata()["epoch"])
            tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118
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


def _under(prefix: str, tensors: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}


def _refuse_collapse(predicted: Tensor, valid: Tensor) -> None:
    spread = [p[v].std(0).mean() for p, v in zip(predicted, valid, strict=True) if v.sum() > 1]
    if spread and float(torch.stack(spread).mean()) < LEAST_SPREAD:
        raise ConfigError(
            f"after {GUARD_STEPS} steps the network predicts the same everywhere, so it has collapsed; "
            "lower learning_rate, or try another seed"
        )


def augmented(examples: Examples, network: NetworkConfig, rng: np.random.Generator) -> Examples:
    """Turned and mirrored copies of examples: physics does not care.

    The canonical frame can only be mirrored along the fold line; the camera's also turned by quarters. Mirroring swaps
    start and end of the fold line, and with them which arm is the first along it.
    """
    images, lines, points = examples.images.copy(), examples.lines.copy(), examples.points.copy()
    side = images.shape[-1]
    for index in range(len(images)):
        if rng.random() < 0.5:
            images[index] = images[index][:, ::-1]
            points[index, ..., 1] = side - 1 - points[index, ..., 1]
            lines[index] = _reversed(lines[index], side) if network.frame == "camera" else lines[index]
            points[index] = points[index][:, ::-1] if network.variant == "2sam" else points[index]
        if network.frame == "camera":
            for _ in range(rng.integers(4)):
                images[index], points[index], lines[index] = _turned(images[index], points[index], lines[index], side)
    return replace(examples, images=images, lines=lines, points=points)


def _reversed(line: NDArray[np.float32], side: int) -> NDArray[np.float32]:
    """The fold line after mirroring the image's y, from end to start so that the same cloth stays on its left."""
    x0, y0, x1, y1 = line
    top = (side - 1) / side
    return np.array([x1, top - y1, x0, top - y0], np.float32)


def _turned(image: NDArray, points: NDArray, line: NDArray, side: int) -> tuple[NDArray, NDArray, NDArray]:
    """A quarter turn: (x, y) becomes (side - 1 - y, x)."""
    top = (side - 1) / side
    turned = np.stack([side - 1 - points[..., 1], points[..., 0]], -1)
    x0, y0, x1, y1 = line
    return np.rot90(image, -1, (1, 2)), turned, np.array([top - y0, x0, top - y1, x1], np.float32)
