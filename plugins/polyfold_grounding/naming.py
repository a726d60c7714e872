"""Which corner of a square or rectangle is called what: decided once, when the episode starts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["named_by_top"]


def named_by_top(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Roll corners [px], shape (V, 2), so that the edge from the second to the third is nearest the image's top."""
    heights = vertices[:, 1] + np.roll(vertices[:, 1], -1)
    return np.roll(vertices, 1 - int(np.argmin(heights)), axis=0)
