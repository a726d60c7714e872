"""How an episode ended, for metrics."""

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
