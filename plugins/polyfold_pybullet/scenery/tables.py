"""Procedural table tops: wood, marble and a plain one with grain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Floats = NDArray[np.float64]

WOODS = ((190, 150, 105), (150, 105, 70), (215, 185, 145), (105, 70, 48), (170, 130, 95))
MARBLES = (((228, 226, 222), (150, 150, 152)), ((70, 72, 76), (170, 170, 168)), ((205, 190, 170), (140, 115, 95)))
PLAINS = ((200, 198, 192), (120, 125, 130), (90, 110, 95), (230, 228, 220), (60, 62, 68))

NAMES = ("wood", "marble", "plain")


def table(name: str, height: int, width: int, rng: np.random.Generator) -> Floats:
    """A picture of an empty table, RGB units 0 to 255, shape (height, width, 3)."""
    return {"wood": _wood, "marble": _marble, "plain": _plain}[name](height, width, rng)


def smooth_noise(shape: tuple[int, int], sigma: float | tuple[float, float], rng: np.random.Generator) -> Floats:
    """Noise of mean 0 and deviation 1, smooth over ``sigma`` [px]."""
    found = ndimage.gaussian_filter(rng.standard_normal(shape), sigma, mode="reflect")
    return np.asarray((found - found.mean()) / found.std())


def _wood(height: int, width: int, rng: np.random.Generator) -> Floats:
    """Planks with grain and growth rings, along the picture's width or its height."""
    upright = rng.random() < 0.5
    tall, long = (width, height) if upright else (height, width)
    base = np.array(WOODS[rng.integers(len(WOODS))], float)
    warp = smooth_noise((tall, long), (30, 120), rng) * rng.uniform(6, 16)
    rows = np.arange(tall)[:, None] + warp
    rings = np.sin(2 * np.pi * rows / rng.uniform(9, 22) + 2 * smooth_noise((tall, long), (5, 60), rng))
    grain = smooth_noise((tall, long), (0.6, 18), rng)
    light = 1.0 + 0.05 * rings + 0.05 * grain
    if rng.random() < 0.7:
        plank = rng.integers(70, 160)
        number = (np.arange(tall) + rng.integers(plank)) // plank
        light *= (1.0 + 0.09 * rng.standard_normal(number.max() + 1))[number][:, None]
        light[np.flatnonzero(np.diff(number))] *= 0.6
    wood = base * light[..., None]
    return wood.transpose(1, 0, 2) if upright else wood


def _marble(height: int, width: int, rng: np.random.Generator) -> Floats:
    """Clouds with veins where folded noise is near zero."""
    ground, vein = (np.array(colour, float) for colour in MARBLES[rng.integers(len(MARBLES))])
    shape = (height, width)
    clouds = smooth_noise(shape, 45, rng)
    share = 0.12 * np.clip(clouds, 0, 2)
    for sigma, strength in ((40, 0.7), (22, 0.5), (10, 0.25)):
        field = smooth_noise(shape, sigma, rng) + 0.25 * smooth_noise(shape, sigma / 4, rng)
        share += (
            strength * np.exp(-np.abs(field) / rng.uniform(0.03, 0.08)) * np.clip(smooth_noise(shape, 60, rng), 0, 1)
        )
    share = np.clip(share, 0, 0.9)[..., None]
    return ground * (1 - share) + vein * share + 2.0 * smooth_noise(shape, 1, rng)[..., None]


def _plain(height: int, width: int, rng: np.random.Generator) -> Floats:
    base = np.array(PLAINS[rng.integers(len(PLAINS))], float)
    return base + 2.5 * smooth_noise((height, width), 1, rng)[..., None]
