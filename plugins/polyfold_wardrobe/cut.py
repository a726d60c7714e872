"""What cutting them shares: corners a little off, colours, and penalties that hold on both sides."""

from __future__ import annotations

import colorsys
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment, Outline, mesh_panels
from polyfold.polygon import Penalty, angle_range

Floats = NDArray[np.float64]
Pair = tuple[str, str]
Vector = tuple[str | tuple[str, ...], str | tuple[str, ...]]
SIDES = ("left", "right")
OFF = 0.004
"""How far each corner may be from where the pattern has it [m]."""


def both_sides(
    half: Mapping[str, tuple[float, float]], names: Iterable[str], rng: np.random.Generator
) -> dict[str, Floats]:
    """Corners in the order of ``names`` from those of the right half [m], each side a little different."""
    corners = {}
    for name in names:
        stem, _, side = name.rpartition("_")
        sign = {"left": -1.0, "right": 1.0}.get(side, 0.0)
        x, y = half[stem if sign else name]
        corners[name] = np.array([sign * x, y]) + rng.uniform(-OFF, OFF, 2)
    return corners


def paired(names: Iterable[str]) -> list[Pair]:
    """Names of what mirrors each other, left first."""
    return [(name, name.replace("_left", "_right")) for name in names if name.endswith("_left")]


def mirrored(pairs: Mapping[Pair, float], rng: np.random.Generator) -> dict[Pair, float]:
    """How far seams bulge [m], the right one's as the left one's but for a fifth; pairs run around the outline."""
    found = {}
    for (a, b), bulge in pairs.items():
        other = b.replace("left", "right"), a.replace("left", "right")
        for pair in {(a, b), other}:
            found[pair] = float(bulge * rng.uniform(0.8, 1.2))
    return found


def sewn(kind: str, seed: int, outline: Outline, layers: int, edge_length: float, rng: np.random.Generator) -> Garment:
    """Mesh an outline; ``rng`` decides the colours, which stand out from a light table."""
    mesh, keypoints = mesh_panels(outline, layers, edge_length)
    hue, saturation, value = rng.uniform(), rng.uniform(0.45, 0.85), rng.uniform(0.40, 0.80)
    outside = _bytes(colorsys.hsv_to_rgb(hue, saturation, value))
    inside = _bytes(colorsys.hsv_to_rgb(hue, 0.55 * saturation, min(0.80, value + 0.12)))
    return Garment(kind, f"{kind}-{seed:04d}", seed, mesh, keypoints, (outside, inside))


def _bytes(colour: tuple[float, float, float]) -> tuple[int, int, int]:
    red, green, blue = (round(255 * channel) for channel in colour)
    return red, green, blue


def turned(of: Vector, to: Vector, side: str, degrees: tuple[float, float], sigma: float = 6.0) -> Penalty:
    """A range of signed angles [deg] as it is on the left side; on the right the mirror image."""
    low, high = degrees if side == "left" else (-degrees[1], -degrees[0])
    return angle_range(of, to, low, high, sigma)
