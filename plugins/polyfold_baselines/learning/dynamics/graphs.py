"""The cloth as a camera sees it, as a graph: nodes spread over the picture, each with its nearest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GroundingError
from polyfold_baselines.demos.window import on_table
from polyfold_baselines.learning.sampling import farthest_first

Floats = NDArray[np.float64]

NODES = 128
NEIGHBOURS = 10
"""The ring about a node and most of the next, as the source's radius of two voxels holds."""


def nodes_of(heights: NDArray, mask: NDArray[np.bool_], extent: float) -> Floats:
    """Nodes of what is seen of the cloth [m], shape (NODES, 3): on the table from the view's middle, and their height.

    Args:
        heights: above the table [m], shape (SIDE, SIDE).
        mask: where cloth is, shape (SIDE, SIDE).
        extent: side of the view on the table [m].

    Raises:
        GroundingError: if none of it is in the view.
    """
    if not mask.any():
        raise GroundingError("no cloth is left in the view; lay it about where it lay at first")
    rows, columns = np.nonzero(inside(mask))
    chosen = farthest_first(np.column_stack([columns, rows]).astype(float), NODES)
    rows, columns = rows[chosen], columns[chosen]
    return np.column_stack([on_table(np.column_stack([columns, rows]), extent), heights[rows, columns]])


def nearest_of(nodes: Floats) -> NDArray[np.int64]:
    """Which nodes, shape (K, 3), are nearest to each, shape (K, NEIGHBOURS), the nearest first."""
    apart = np.linalg.norm(nodes[:, None] - nodes[None], axis=-1)
    np.fill_diagonal(apart, np.inf)
    return np.argsort(apart, axis=1)[:, :NEIGHBOURS]


def inside(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The cloth without its rim, where a pixel's height is half the table's; all of it where it is but rim."""
    import cv2

    inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return inner if inner.any() else mask
