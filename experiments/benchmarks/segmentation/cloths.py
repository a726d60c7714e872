"""The cloth of drawn garments: colours, wrinkles, stripes, checks, dots, prints and yokes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from polyfold_pybullet.scenery.tables import smooth_noise
from scipy import ndimage

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

COLOURS = (
    (235, 235, 232), (28, 28, 32), (40, 52, 98), (158, 32, 38), (128, 130, 134), (46, 92, 60),
    (205, 160, 52), (222, 150, 165), (130, 170, 212), (212, 200, 178), (88, 50, 110), (220, 96, 40),
)  # fmt: skip

APART = 70.0
"""Cloth differs from the table's mean colour by at least this much [RGB units]."""

PATTERNS = ("stripes", "checks", "dots", "print", "yoke")


def cloth(mask: Mask, table_colour: Floats, pattern: str | None, rng: np.random.Generator) -> Floats:
    """Colours of a cloth that covers a mask, RGB units, shape (H, W, 3); only those on the mask matter."""
    first = _colour(table_colour, rng)
    colours = np.broadcast_to(first, (*mask.shape, 3)).copy()
    if pattern is not None:
        other = _colour(table_colour, rng, first)
        colours[_patterned(mask, pattern, rng)] = other
    weave = 1.0 + 0.02 * smooth_noise(mask.shape, 0.8, rng)
    return colours * (_wrinkles(mask, rng) * weave)[..., None]


def _colour(table_colour: Floats, rng: np.random.Generator, beside: Floats | None = None) -> Floats:
    far = [np.array(colour, float) for colour in COLOURS if np.linalg.norm(colour - table_colour) > APART]
    if beside is not None:
        far = [colour for colour in far if np.linalg.norm(colour - beside) > APART]
    return np.clip(far[rng.integers(len(far))] + rng.normal(0, 5, 3), 4, 250)


def _wrinkles(mask: Mask, rng: np.random.Generator) -> Floats:
    """Light on creased cloth: slopes of a smooth height, and a darker rim where it curves down to the table."""
    height = smooth_noise(mask.shape, 18, rng) + 0.4 * smooth_noise(mask.shape, (4, 25), rng)
    slope = ndimage.sobel(height, axis=int(rng.integers(2)))
    depth = np.asarray(ndimage.distance_transform_edt(mask))
    return 1.0 + 0.07 * slope / slope.std() - 0.15 * np.exp(-depth / 2.0)


def _patterned(mask: Mask, pattern: str, rng: np.random.Generator) -> Mask:
    """Where the second colour is, bool, shape (H, W)."""
    rows, columns = np.indices(mask.shape).astype(float)
    angle = rng.uniform(0, np.pi)
    along = rows * np.cos(angle) + columns * np.sin(angle)
    across = columns * np.cos(angle) - rows * np.sin(angle)
    period = rng.uniform(16, 44)
    if pattern == "stripes":
        return along % period < 0.45 * period
    if pattern == "checks":
        return (along % period < 0.4 * period) ^ (across % period < 0.4 * period)
    if pattern == "dots":
        return np.hypot(along % period - period / 2, across % period - period / 2) < 0.28 * period
    inside = np.argwhere(mask)
    low, high = inside.min(axis=0), inside.max(axis=0)
    if pattern == "yoke":
        return rows < low[0] + rng.uniform(0.2, 0.4) * (high[0] - low[0])
    middle, size = (low + high) / 2, 0.16 * float((high - low).min())
    radius = size * (1.0 + 0.3 * np.sin(5 * np.arctan2(rows - middle[0], columns - middle[1])))
    return np.hypot(rows - middle[0], columns - middle[1]) < radius
