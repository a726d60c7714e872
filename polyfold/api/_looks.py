"""The colours of a garment in a photograph, as its twin wears them."""

from __future__ import annotations

import colorsys

import numpy as np
from numpy.typing import NDArray

from polyfold.viz._draw._cloth import TABLE

Colour = tuple[int, int, int]

EDGE = 5
"""Pixels along the outline that are left out: they are partly table."""
CLEAR = 90.0
"""How far from the simulated table's colour the cloth's must be for a segmenter to find it in any shade [RGB units]."""


def colours_in(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> tuple[Colour, Colour]:
    """Outside and inside colour of a garment of which the outside is seen.

    The outside is the median of its pixels, darkened where it would not stand out from the light simulated table; the
    inside, which no photograph shows, is paler, as that of seeded garments.

    Args:
        rgb: the photograph, uint8, shape (H, W, 3).
        mask: where the garment is, bool, shape (H, W); not empty.
    """
    import cv2

    inner = cv2.erode(mask.astype(np.uint8), np.ones((2 * EDGE + 1, 2 * EDGE + 1), np.uint8)) > 0
    red, green, blue = np.median(rgb[inner if inner.any() else mask], axis=0) / 255
    hue, saturation, value = colorsys.rgb_to_hsv(float(red), float(green), float(blue))
    outside = _standing_out(hue, saturation, value)
    paler = _standing_out(hue, 0.55 * saturation, min(0.80, value + 0.12))
    return outside, paler


def _standing_out(hue: float, saturation: float, value: float) -> Colour:
    """The colour itself, or as little darker as it takes."""
    while True:
        red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(hue, saturation, value))
        if np.linalg.norm(np.subtract((red, green, blue), TABLE)) >= CLEAR:
            return red, green, blue
        value -= 0.01
