"""How an episode ended, for metrics, and the bounds that success is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold._brief import brief
from polyfold.errors import ConfigError
from polyfold.garments import Mesh
from polyfold.types._state import SimState


@dataclass(frozen=True, eq=False, repr=False)
class Outcome:
    """How an episode began and ended, for metrics; privileged.

    Attributes:
        start: state of the flat garment.
        end: state after the last fold.
        mask: the cloth in the last picture, bool, shape (H, W).
        mesh: of the garment: which particles are neighbours, and which are its outline.
    """

    start: SimState
    end: SimState
    mask: NDArray[np.bool_]
    mesh: Mesh

    __repr__ = brief


@dataclass(frozen=True)
class Threshold:
    """A bound on a metric: at most ``bound`` where lower is better, at least ``bound`` where higher is.

    Attributes:
        metric: its registered name.
        bound: in the metric's unit.
        higher_is_better: which way is good.
        best: the value of a perfect result where higher is better: 1 for an overlap, 100 for one in percent.
    """

    metric: str
    bound: float
    higher_is_better: bool = False
    best: float = 1.0

    def __post_init__(self) -> None:
        if self.higher_is_better and self.bound > self.best:
            raise ConfigError(
                f"the threshold on {self.metric!r} asks for {self.bound:g}, and the best value is {self.best:g}; "
                "give its best value, such as best=100 for percent"
            )

    def holds(self, value: float) -> bool:
        """Whether a value meets the bound; NaN (nothing to measure) does."""
        return bool(np.isnan(value) or (value >= self.bound if self.higher_is_better else value <= self.bound))

    def share(self, value: float) -> float:
        """How much of what the bound allows a value takes up: an error of its bound, a score of the way to best.

        NaN (nothing to measure) takes up nothing; at most 1 meets the bound.
        """
        if np.isnan(value):
            return 0.0
        missing, allowed = (self.best - value, self.best - self.bound) if self.higher_is_better else (value, self.bound)
        if allowed == 0.0:
            return 0.0 if self.holds(value) else math.inf
        return missing / allowed
