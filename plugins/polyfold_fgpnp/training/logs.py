"""Training logs: plain JSON lines always, and TensorBoard's format where it is installed."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError
from polyfold.logs import JsonLines
from polyfold_fgpnp.training.runs import METRICS


class Logs:
    """Writes metrics by epoch into ``metrics.jsonl`` and, with the package ``tensorboard``, for TensorBoard.

    Args:
        out: the folder.
        done: epochs that are finished; what was logged after them, by a run that was killed, is dropped.
    """

    def __init__(self, out: Path, done: int) -> None:
        self._lines = JsonLines(out / METRICS)
        records = self._sound_records()
        self._drop_after(records, done)
        if lacking := sorted(set(range(1, done + 1)) - {record["epoch"] for record in records}):
            named = ", ".join(map(str, lacking))
            warnings.warn(f"{self._lines.path} lacks epoch {named}; the weights don't depend on it", stacklevel=2)
        self._board = _tensorboard(out, done)

    def _sound_records(self) -> list[dict[str, Any]]:
        """What was logged; damaged lines are set aside."""
        records, damaged = self._lines.sound(_logged)
        if damaged:
            beside = self._lines.set_aside(damaged)
            warnings.warn(f"{len(damaged)} damaged lines of {self._lines.path} are set aside in {beside}", stacklevel=3)
        return records

    def _drop_after(self, records: list[dict[str, Any]], done: int) -> None:
        """End the file behind the last of its first epochs, each standing once, that are done."""
        end, last = 0, 0
        for record, (_, stop) in zip(records, self._lines.lines(), strict=False):
            if not last < record["epoch"] <= done:
                break
            end, last = stop, record["epoch"]
        if self._lines.path.exists():
            os.truncate(self._lines.path, end)

    def __enter__(self) -> Logs:
        return self

    def __exit__(self, *error: Any) -> None:
        if self._board is not None:
            self._board.close()

    def write(self, epoch: int, metrics: Mapping[str, float]) -> None:
        """Log the metrics after an epoch."""
        self._lines.append({"epoch": epoch, **metrics})
        if self._board is not None:
            for name, value in metrics.items():
                self._board.add_scalar(name, value, epoch)


def _logged(record: dict[str, Any], where: str) -> dict[str, Any]:
    if not isinstance(record.get("epoch"), int):
        raise ConfigError(f"{where} says of no epoch how it was")
    return record


def _tensorboard(out: Path, done: int) -> Any:
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ModuleNotFoundError:
        return None
    return SummaryWriter(str(out), purge_step=done + 1)
