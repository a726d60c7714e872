"""Fabric colours that stand out from a light table."""

from __future__ import annotations

import colorsys

import numpy as np

Colour = tuple[int, int, int]


def fabric_colours(rng: np.random.Generator) -> tuple[Colour, Colour]:
    """An outside colour and a paler inside colour, RGB in 0..255, both well away from a light grey table."""
    hue, saturation, value = rng.uniform(), rng.uniform(0.45, 0.85), rng.uniform(0.40, 0.80)
    outside = np.array(colorsys.hsv_to_rgb(hue, saturation, value))
    inside = np.array(colorsys.hsv_to_rgb(hue, 0.55 * saturation, min(0.80, value + 0.12)))
    return _bytes(outside), _bytes(inside)


def _bytes(colour: np.ndarray) -> Colour:
    red, green, blue = (round(255 * float(channel)) for channel in colour)
    return red, green, blue
