"""Training logs: plain JSON lines always, and TensorBoard's format where it is installed."""

from __future__ import annotations

import os
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import Any

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
        self._drop_after(done)
        self._board = _tensorboard(out, done)

    def _drop_after(self, done: int) -> None:
        ends = [0, *(end for _, end in islice(self._lines.lines(), done))]
        if self._lines.path.exists():
            os.truncate(self._lines.path, ends[-1])

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


def _tensorboard(out: Path, done: int) -> Any:
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ModuleNotFoundError:
        return None
    return SummaryWriter(str(out), purge_step=done + 1)
