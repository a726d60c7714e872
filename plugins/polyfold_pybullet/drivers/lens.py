"""Pictures as a lens without distortion would have taken them."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Lens = Literal["none", "brown-conrady", "inverse-brown-conrady"]
ROUNDS = 8
"""Steps of the fixed point that turns a distortion around; it converges by a factor of about ten each."""


def straightening(intrinsics: Floats, coefficients: Floats, lens: Lens, size: tuple[int, int]) -> Floats | None:
    """Where each pixel of the straightened picture is found in the one taken: (column, row) [px], shape (H, W, 2).

    Args:
        intrinsics: pinhole matrix [px], shape (3, 3).
        coefficients: k1, k2, p1, p2, k3 (Brown 1966), shape (5,).
        lens: whether they distort, or undo it.
        size: (width, height) [px].

    Returns:
        None if nothing is to be done.
    """
    if lens == "none" or not np.any(coefficients):
        return None
    width, height = size
    rows, columns = np.indices((height, width)).astype(float)
    focal, middle = intrinsics[[0, 1], [0, 1]], intrinsics[:2, 2]
    straight = (np.stack([columns, rows], axis=-1) - middle) / focal
    if lens == "brown-conrady":
        return _bent(straight, coefficients) * focal + middle
    found = straight
    for _ in range(ROUNDS):
        found = found + straight - _bent(found, coefficients)
    return found * focal + middle


def _bent(points: Floats, coefficients: Floats) -> Floats:
    k1, k2, p1, p2, k3 = coefficients
    x, y = points[..., 0], points[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.stack(
        [x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)],
        axis=-1,
    )
