"""Colours of a table under light that changes: how unlike them a pixel is, shadows and sun spots allowed for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]

BAND = 0.04
"""Width of the picture's border, where the table is looked at, as a share of the shorter side."""

MOST_COLOURS = 6
"""Colours that a table's border is described with: planks, veins, a sleeve or a hand that reaches in."""

RAREST = 0.004
"""Colours of a smaller share of the border than this are left out."""

NOISE = 6.0
"""Colours nearer to each other than this are one [RGB units]."""

FACTORS = np.exp(np.linspace(np.log(0.3), np.log(2.4), 15))
"""How bright a place may be beside another of the same colour: from a deep shadow to a sun spot."""

UNTHINKABLE = 60.0
"""Light that costs more than this is not tried."""


@dataclass(frozen=True, eq=False)
class Colour:
    """One colour of a table: mean, shape (3,), and covariance, shape (3, 3) [RGB units]."""

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]


def border_band(shape: tuple[int, int]) -> Mask:
    """The picture's border, bool, shape (H, W)."""
    width = max(2, round(BAND * min(shape)))
    band = np.ones(shape, bool)
    band[width:-width, width:-width] = False
    return band


def colours_of(pixels: Picture) -> list[Colour]:
    """The colours that pixels, uint8, shape (N, 3), have, by k-means; the same for the same pixels."""
    import cv2

    values = pixels.astype(np.float32)
    cv2.setRNGSeed(0)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 20, 0.5)
    start = np.zeros((len(values), 1), np.int32)
    count = min(MOST_COLOURS, len(values))
    _, labels, _ = cv2.kmeans(values, count, start, stop, 2, cv2.KMEANS_PP_CENTERS)
    parts = [values[labels[:, 0] == label].astype(float) for label in range(count)]
    enough = [part for part in parts if len(part) > max(1, RAREST * len(values))]
    return [Colour(part.mean(axis=0), np.cov(part.T)) for part in enough]


def unlike(rgb: Picture, colours: Sequence[Colour], light: float) -> Floats:
    """How far each pixel is from the nearest of some colours in the likeliest light, shape (H, W).

    The unit is a standard deviation of the colours; what the light would have to be counts as well.

    Args:
        rgb: the picture, uint8, shape (H, W, 3).
        colours: of the table.
        light: by how much it varies over the table, standard deviation of the logarithm of its brightness.
    """
    pixels = rgb.reshape(-1, 3).astype(np.float32)
    nearest = np.full(len(pixels), np.inf, np.float32)
    for colour in colours:
        for factor, cost in _lights(light):
            # Texture grows with the light, and the camera's white is the end of it.
            spread = colour.covariance * min(factor**2, 1.5) + NOISE**2 * np.eye(3)
            root = np.linalg.cholesky(np.linalg.inv(spread)).astype(np.float32)
            off = (pixels - np.minimum(255.0, factor * colour.mean).astype(np.float32)) @ root
            np.minimum(nearest, np.square(off).sum(axis=1) + np.float32(cost), out=nearest)
    return np.sqrt(nearest).reshape(rgb.shape[:2])


def unlike_picture(rgb: Picture, before: Picture, light: float, noise: float) -> Floats:
    """How far each pixel is from the same place of another picture in the likeliest light, shape (H, W).

    Args:
        rgb: the picture, uint8, shape (H, W, 3).
        before: the other, of the same shape.
        light: by how much it varies, standard deviation of the logarithm of its brightness.
        noise: of both pictures [RGB units].
    """
    pixels, places = rgb.astype(np.float32), before.astype(np.float32)
    nearest = np.full(rgb.shape[:2], np.inf, np.float32)
    for factor, cost in _lights(light):
        off = (pixels - np.minimum(255.0, np.float32(factor) * places)) / np.float32(noise)
        np.minimum(nearest, np.square(off).sum(axis=2) + np.float32(cost), out=nearest)
    return np.sqrt(nearest)


def _lights(light: float) -> list[tuple[float, float]]:
    """The factors that are thinkable and what each costs."""
    costs = (np.log(FACTORS) / light) ** 2
    return [(float(f), float(cost)) for f, cost in zip(FACTORS, costs, strict=True) if cost <= UNTHINKABLE]
