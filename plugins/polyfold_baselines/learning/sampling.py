"""Points spread over others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def farthest_first(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Indices of points, shape (N, 2), each the farthest from those before.

    Where there are fewer than ``count`` they begin again.
    """
    nearest = np.hypot(*(points - points.mean(0)).T)
    chosen = np.empty(min(count, len(points)), np.int64)
    chosen[0] = int(np.argmax(nearest))
    nearest = np.hypot(*(points - points[chosen[0]]).T)
    for place in range(1, len(chosen)):
        chosen[place] = int(np.argmax(nearest))
        nearest = np.minimum(nearest, np.hypot(*(points - points[chosen[place]]).T))
    return np.resize(chosen, count)
