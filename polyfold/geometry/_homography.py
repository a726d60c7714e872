"""Homographies: how one plane is seen on another."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError

Floats = NDArray[np.float64]


def homography(pixels: ArrayLike, places: ArrayLike) -> Floats:
    """The homography, shape (3, 3), that maps points, shape (N >= 4, 2), to others by least squares."""
    import cv2

    found, _ = cv2.findHomography(np.asarray(pixels, float), np.asarray(places, float))
    return np.asarray(found / np.linalg.norm(found), np.float64)


def mapped(matrix: Floats, points: Floats) -> Floats:
    """Where a homography, shape (3, 3), maps points to, both of shape (N, 2).

    Raises:
        GarmentError: if the horizon lies between them.
    """
    found = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    if (found[:, 2] * np.sign(np.median(found[:, 2])) <= 1e-12).any():
        raise GarmentError("what was outlined reaches beyond the table's horizon; photograph it from a steeper angle")
    return found[:, :2] / found[:, 2:]
