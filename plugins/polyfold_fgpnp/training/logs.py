"""Training logs: plain JSON lines always, and TensorBoard's format where it is installed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any


class Logs:
    """Writes metrics by epoch into ``metrics.jsonl`` and, with the package ``tensorboard``, for TensorBoard.

    Args:
        out: the folder.
        done: epochs that are finished; what was logged after them, by a run that was killed, is dropped.
    """

    def __init__(self, out: Path, done: int) -> None:
        self._path = out / "metrics.jsonl"
        lines = self._path.read_text("utf-8").splitlines()[:done] if self._path.exists() else []
        self._path.write_text("".join(line + "\n" for line in lines), "utf-8")
        self._board = _tensorboard(out, done)

    def __enter__(self) -> Logs:
        return self

    def __exit__(self, *error: Any) -> None:
        if self._board is not None:
            self._board.close()

    def write(self, epoch: int, metrics: Mapping[str, float]) -> None:
        """Log the metrics after an epoch."""
        with self._path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"epoch": epoch, **metrics}) + "\n")
        if self._board is not None:
            for name, value in metrics.items():
                self._board.add_scalar(name, value, epoch)


def _tensorboard(out: Path, done: int) -> Any:
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ModuleNotFoundError:
        return None
    return SummaryWriter(str(out), purge_step=done + 1)
