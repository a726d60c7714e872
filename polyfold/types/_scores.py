"""How an episode ended, for metrics, and the bounds that success is made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.types._state import SimState


@dataclass(frozen=True, eq=False)
class Outcome:
    """How an episode began and ended, for metrics; privileged.

    Attributes:
        start: state of the flat garment.
        end: state after the last fold.
        mask: the cloth in the last picture, bool, shape (H, W).
    """

    start: SimState
    end: SimState
    mask: NDArray[np.bool_]


@dataclass(frozen=True)
class Threshold:
    """A bound on a metric: at most ``bound`` where lower is better, at least ``bound`` where higher is.

    Attributes:
        metric: its registered name.
        bound: in the metric's unit.
        higher_is_better: which way is good.
    """

    metric: str
    bound: float
    higher_is_better: bool = False

    def holds(self, value: float) -> bool:
        """Whether a value meets the bound; NaN (nothing to measure) does."""
        return bool(np.isnan(value) or (value >= self.bound if self.higher_is_better else value <= self.bound))

    def share(self, value: float) -> float:
        """How much of what the bound allows a value takes up: an error of its bound, an overlap of what may miss to 1.

        NaN (nothing to measure) takes up nothing; at most 1 meets the bound.
        """
        if np.isnan(value):
            return 0.0
        return (1.0 - value) / (1.0 - self.bound) if self.higher_is_better else value / self.bound
