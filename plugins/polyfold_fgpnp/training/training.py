"""Training a value network: resumable, on a processor or a GPU, with a guard against collapse."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch

from polyfold.errors import ConfigError
from polyfold.logs import exclusive
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.policies.weights import Provenance, save_weights
from polyfold_fgpnp.training.config import TrainingConfig
from polyfold_fgpnp.training.examples import Examples, make_examples
from polyfold_fgpnp.training.learner import Learner
from polyfold_fgpnp.training.logs import Logs
from polyfold_fgpnp.training.runs import snapshot_name


def train(config: TrainingConfig, out: str | Path, device: str = "auto", progress: bool = True) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        config: what to do.
        out: folder for ``weights.safetensors``, snapshots such as ``weights-0020.safetensors``,
            ``checkpoint.safetensors``, ``metrics.jsonl`` and TensorBoard's log.
        device: ``cpu``, ``cuda`` or ``auto``.
        progress: show a progress bar.

    Raises:
        ConfigError: if the folder holds another training or is in use, data or the device is missing, or the network
            has collapsed.
    """
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
    run = Learner(config, learned, target)
    provenance = Provenance(config.plain(), hashes, run.mean, run.deviation, int(learned.valid.sum()))
    with exclusive(out):
        (out / "training.json").write_text(note, "utf-8")
        _learn(run, validation, provenance, config, out, progress)
        save_weights(out / "weights.safetensors", run.network, provenance)
    return out / "weights.safetensors"


def _learn(
    run: Learner, validation: Examples, provenance: Provenance, config: TrainingConfig, out: Path, progress: bool
) -> None:
    """The epochs that are not done yet, each with its metrics, its snapshot if one is wanted, and a checkpoint."""
    from tqdm.auto import tqdm

    first = run.resume(out / "checkpoint.safetensors")
    with Logs(out, first) as logs, tqdm(total=config.epochs, initial=first, unit="epoch", disable=not progress) as bar:
        for epoch in range(first, config.epochs):
            loss = run.epoch(epoch)
            found = {"loss": loss, **run.validate(validation)}
            logs.write(epoch + 1, found)
            if epoch + 1 in config.snapshots:  # before the checkpoint: a run killed between the two writes it again
                so_far = replace(provenance, config={**provenance.config, "epochs_done": epoch + 1})
                save_weights(out / snapshot_name(epoch + 1), run.network, so_far)
            run.save(out / "checkpoint.safetensors", epoch + 1)
            # Of states with one trial each no ranks are known.
            known = {name: f"{value:.3f}" for name, value in found.items() if math.isfinite(value)}
            bar.set_postfix(known, refresh=False)
            bar.update()


def _device(name: str) -> torch.device:
    if name == "cuda" and not torch.cuda.is_available():
        raise ConfigError("PyTorch finds no GPU here; train with --device cpu, or install PyTorch with CUDA")
    return torch.device(("cuda" if torch.cuda.is_available() else "cpu") if name == "auto" else name)


def _refuse_another(out: Path, wanted: str) -> None:
    """Refuse a folder whose note says that it holds another training."""
    note = out / "training.json"
    if not note.exists() or (held := note.read_bytes()) == wanted.encode():
        return
    try:
        json.loads(held)
    except ValueError as error:
        advice = "remove that file to go on with the configuration given, or choose another folder"
        raise ConfigError(f"{note} is damaged ({error}); {advice}") from error
    raise ConfigError(f"{out} holds a training with another configuration or other data; choose another folder")


def _split(examples: Examples, held_out: float) -> tuple[Examples, Examples]:
    """Training and validation states; a garment is in one of the two."""
    garments = np.unique(examples.garments)
    if len(garments) < 2:
        raise ConfigError("the data holds fewer than two garments, so none can be held out; collect from more")
    kept = garments[: max(1, min(len(garments) - 1, round(len(garments) * (1 - held_out))))]
    learned = np.isin(examples.garments, kept)
    return examples.chosen(learned), examples.chosen(~learned)
