"""Pictures of the cloth while it moves: kept for a film, and shown to whoever watches."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from polyfold.api._fold import GIF_RATE
from polyfold.plugins.interfaces import RecordsMotion, Simulator
from polyfold.types import Observation
from polyfold.viz._film import Moment


class Motion:
    """What a simulator shows of folds, where it can.

    Args:
        simulator: that moves the cloth.
        folds: tells how many are done.

    Attributes:
        moments: for a film, in order.
    """

    def __init__(self, simulator: Simulator, folds: Callable[[], int]) -> None:
        self._simulator, self._folds = simulator, folds
        self._watcher: Callable[[Observation], Any] | None = None
        self.moments: list[Moment] = []
        if isinstance(simulator, RecordsMotion):
            simulator.record(self._moved, GIF_RATE)

    @contextmanager
    def watched(self, watcher: Callable[[Observation], Any]) -> Iterator[None]:
        """Hand a watcher each picture, too."""
        self._watcher = watcher
        try:
            yield
        finally:
            self._watcher = None

    def forget_undone(self) -> None:
        """Drop what belongs to folds that were taken back or broken off."""
        self.moments = [moment for moment in self.moments if moment.fold < self._folds()]

    def _moved(self, seen: Observation) -> None:
        self.moments.append(Moment(seen, self._simulator.state(), self._folds()))
        if self._watcher is not None:
            self._watcher(seen)
