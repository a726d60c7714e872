"""Homographies: how one plane is seen on another."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError

Floats = NDArray[np.float64]


def homography(pixels: ArrayLike, places: ArrayLike) -> Floats:
    """The homography, shape (3, 3), that maps points, shape (N >= 4, 2), to others by least squares."""
    start, end = np.asarray(pixels, float), np.asarray(places, float)
    inner, outer = _centring(start), _centring(end)
    x, y = mapped(inner, start).T
    u, v = mapped(outer, end).T
    one, zero = np.ones_like(x), np.zeros_like(x)
    rows = np.vstack([
        np.column_stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u]),
        np.column_stack([zero, zero, zero, x, y, one, -v * x, -v * y, -v]),
    ])  # fmt: skip
    found = np.linalg.inv(outer) @ np.linalg.svd(rows)[2][-1].reshape(3, 3) @ inner
    return found / np.linalg.norm(found)


def _centring(points: Floats) -> Floats:
    """Moves points to a mean of 0 and a spread of 1, without which least squares of pixels loses digits."""
    middle = points.mean(axis=0)
    spread = float(np.abs(points - middle).mean()) or 1.0
    return np.array([[1 / spread, 0, -middle[0] / spread], [0, 1 / spread, -middle[1] / spread], [0, 0, 1]])


def mapped(matrix: Floats, points: Floats) -> Floats:
    """Where a homography, shape (3, 3), maps points to, both of shape (N, 2).

    Raises:
        GarmentError: if the horizon lies between them.
    """
    found = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    if (found[:, 2] * np.sign(np.median(found[:, 2])) <= 1e-12).any():
        raise GarmentError("what was outlined reaches beyond the table's horizon; photograph it from a steeper angle")
    return found[:, :2] / found[:, 2:]
