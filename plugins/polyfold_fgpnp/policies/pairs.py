"""Numbers that describe two picks on a flap, whichever is named first and however the cloth lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.affordance import quadrilateral_area
from polyfold_fgpnp.policies.region import FoldRegion

GEOMETRY = 6
"""How many numbers describe a pair."""


def pair_geometry(region: FoldRegion, first: ArrayLike, second: ArrayLike) -> NDArray[np.float32]:
    """Area that the picks span with the line, their mean and differing distance from it, how far they are apart along
    it and at all, each over the flap's size, and whether they become one arm; shape (..., GEOMETRY).

    Args:
        region: the flap.
        first, second: pixels, shape (..., 2).
    """
    first, second = np.asarray(first, float), np.asarray(second, float)
    line = region.fold_line
    near, far = line.distance(first), line.distance(second)
    direction = (np.asarray(line.end) - line.start) / line.length
    apart = np.hypot(*np.moveaxis(first - second, -1, 0))
    depth, root = region.distances.max(), np.sqrt(region.box_area)
    numbers = (
        quadrilateral_area(line.start, line.end, first, second) / region.box_area,
        (near + far) / (2 * depth),
        np.abs(near - far) / depth,
        np.abs((first - second) @ direction) / root,
        apart / root,
        apart < PickConfig().one_arm_px,
    )
    return np.stack(np.broadcast_arrays(*numbers), axis=-1).astype(np.float32)
