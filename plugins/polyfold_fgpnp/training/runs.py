"""Trainings on disk: their folders as `polyfold train` leaves them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError
from polyfold.logs import JsonLines
from polyfold_fgpnp.data.dataset import describe_dataset

METRICS = "metrics.jsonl"
"""File of the metrics by epoch, in the folder of a training."""


def snapshot_name(epoch: int) -> str:
    """File of the weights after an epoch, in the folder of the training."""
    return f"weights-{epoch:04d}.safetensors"


@dataclass(frozen=True)
class TrainingRun:
    """A folder of `polyfold train`, finished or not.

    Attributes:
        path: the folder.
        config: what was trained, plain data.
        metrics: one entry per finished epoch: ``epoch``, ``loss``, ``validation_loss``, ``rank_correlation``.
        folds: number of folds in the data that it uses.
    """

    path: Path
    config: Mapping[str, Any]
    metrics: Sequence[Mapping[str, float]]
    folds: int

    def weights(self) -> dict[int, Path]:
        """Files of weights by the epochs done, in order: the snapshots, and the end if the training has come to it."""
        found = {epoch: self.path / snapshot_name(epoch) for epoch in range(1, self.config["epochs"] + 1)}
        found = {epoch: path for epoch, path in found.items() if path.exists()}
        end = self.path / "weights.safetensors"
        return found | ({self.config["epochs"]: end} if end.exists() else {})


def read_run(path: str | Path) -> TrainingRun:
    """Read a training's folder.

    Raises:
        ConfigError: if it is none, or its number of folds can't be told because its data is not where it was.
    """
    path = Path(path)
    note, log = path / "training.json", JsonLines(path / METRICS)
    if not note.exists():
        raise ConfigError(f"{path} holds no training; give the --out of `polyfold train`")
    try:
        config = json.loads(note.read_text("utf-8"))["config"]
    except (ValueError, KeyError, TypeError) as error:
        raise ConfigError(f"{note} is damaged ({error}); train with the same file into another folder") from error
    return TrainingRun(path, config, log.read(), sum(_folds(data, config["folds"]) for data in config["data"]))


def _folds(data: str, most: int | None) -> int:
    """Folds that a training with this limit uses of a data set."""
    if not Path(data).exists():
        raise ConfigError(f"the data set {data} of a training is not there; run this where the training was run")
    there = describe_dataset(data)["counts"]["folds"]
    return there if most is None else min(there, most)
