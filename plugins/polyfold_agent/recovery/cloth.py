"""Where cloth is in a picture: how far it reaches, what of it is near a point, how high it lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine
from polyfold.types import Observation

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


def reach(mask: Mask, line: FoldLine) -> float:
    """How far the cloth reaches to the left of a line [px]."""
    y, x = np.nonzero(mask)
    return float(line.distance(np.column_stack([x, y])).max())


def heights(observation: Observation, mask: Mask) -> NDArray[np.float32]:
    """Height of the cloth above the table [m], shape (H, W); 0 beside it and where no depth was measured."""
    above = np.nan_to_num(observation.camera.elevation - observation.depth)
    return np.where(mask, np.maximum(above, 0.0), 0.0).astype(np.float32)


def near(point: ArrayLike, radius: float, among: Mask) -> Mask:
    """Which pixels of a mask lie within ``radius`` [px] of a point [px], shape (2,)."""
    y, x = np.ogrid[: among.shape[0], : among.shape[1]]
    column, row = np.asarray(point, float)
    return ((x - column) ** 2 + (y - row) ** 2 <= radius**2) & among


def inside(mask: Mask, point: Floats, inset: float = 2.5) -> Floats:
    """The pixel, shape (2,), at least ``inset`` [px] deep in the cloth that is nearest to a point [px], shape (2,)."""
    import cv2

    deep = cv2.distanceTransform(np.pad(mask.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    y, x = np.nonzero(deep >= min(inset, float(deep.max())))
    nearest = int(np.argmin((x - point[0]) ** 2 + (y - point[1]) ** 2))
    return np.array([x[nearest], y[nearest]], float)
