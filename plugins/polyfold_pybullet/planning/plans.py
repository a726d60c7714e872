"""What planning ends in: timed motions of both arms."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """One movement of both arms from rest to rest; an arm that waits has the same joint angles throughout.

    Attributes:
        name: what it is for, such as ``carry``.
        times: from its start [s], shape (T,).
        joints: joint angles of each arm at these times [rad, m], shapes (T, N) each.
        closed: whether each hand is closed; set before the motion begins.
    """

    name: str
    times: Floats
    joints: tuple[Floats, Floats]
    closed: tuple[bool, bool]

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self.times[-1])

    def at(self, times: NDArray[np.float64]) -> tuple[Floats, Floats]:
        """Joint angles of each arm at other times [s], shape (S,), by linear interpolation: shapes (S, N)."""

        def between(joints: Floats) -> Floats:
            return np.stack([np.interp(times, self.times, column) for column in joints.T], axis=1)

        left, right = self.joints
        return between(left), between(right)


@dataclass(frozen=True, eq=False)
class FoldPlan:
    """A fold that the arms can do.

    Attributes:
        mode: whether the arms fold at once, one after the other, or only one of them does.
        arms: which arm, 0 or 1, does each pick.
        motions: what they do, from parked to parked.
        settling: pause after each change of a hand [s].
    """

    mode: Literal["at once", "in sequence", "one arm"]
    arms: tuple[int, ...]
    motions: tuple[Motion, ...]
    settling: float = 0.3

    @property
    def duration(self) -> float:
        """How long it takes [s], pauses for the hands included."""
        hands = [motion.closed for motion in self.motions]
        changes = sum(one != other for one, other in pairwise(hands))
        return sum(motion.duration for motion in self.motions) + self.settling * changes
