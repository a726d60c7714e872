"""What metrics share: laying a result rigidly onto its reference, for studies in which where it lies is no fault."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import rotate, turn_onto

Floats = NDArray[np.float64]


class Alignable(BaseModel):
    """Parameters that all metrics share."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    align: bool = Field(default=False, description="move and turn the result rigidly onto the reference first")


class Aligning:
    """A metric whose only parameter is whether to align."""

    class Config(Alignable):
        """Parameters."""

    def __init__(self, config: Config | None = None) -> None:
        self._align = (config or self.Config()).align


def laid_onto(particles: Floats, wanted: Floats, points: Floats) -> Floats:
    """Points on the table [m], shape (M, 2), after the rigid motion of particles, shape (N, 3), onto ``wanted``."""
    centre, goal = particles[:, :2].mean(axis=0), wanted[:, :2].mean(axis=0)
    return rotate(points, turn_onto(particles[:, :2], wanted[:, :2]), centre) + goal - centre
