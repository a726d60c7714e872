"""Vertices that a fold brings onto each other: after the refit, too, the model says one place for both."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import FoldLine

Floats = NDArray[np.float64]

_MEANT = 0.008
"""How far from a vertex a line may lay another one that is meant to come onto it, as a share of the garment's size: 1
px for one of 150 x 150 px, which is what lines lose whose ends are given in whole pixels."""

_APART = 0.05
"""How far apart fitted vertices may lie that were brought together, as a share of the garment's size; beyond that, a
later fold has parted them."""

Pair = tuple[str, str]


def meetings(points: Mapping[str, Floats], line: FoldLine, size: float) -> tuple[Pair, ...]:
    """Which vertices a fold line brings onto which: it is the perpendicular bisector of the two.

    Args:
        points: name -> position before the fold [px], shape (2,).
        line: the line as planned [px].
        size: of the garment [px], the square root of its area.
    """
    names, places = list(points), np.array(list(points.values()))
    away = line.distance(places)
    lifted, lying = np.flatnonzero(away > _MEANT * size), np.flatnonzero(away < -_MEANT * size)
    landed = line.mirror(places[lifted])
    apart = np.linalg.norm(landed[:, None] - places[lying][None], axis=2)
    return tuple((names[lifted[i]], names[lying[j]]) for i, j in np.argwhere(apart <= _MEANT * size))


def together(points: Mapping[str, Floats], pairs: Iterable[Pair], size: float) -> dict[str, Floats]:
    """Positions [px] with those of vertices that have met, directly or through others, at their common mean."""
    groups = {name: [name] for name in points}

    def near(a: str, b: str) -> bool:
        return float(np.hypot(*(points[a] - points[b]))) <= _APART * size

    for a, b in pairs:
        one, other = groups[a], groups[b]
        if one is not other and all(near(p, q) for p in one for q in other):
            one += other
            groups |= dict.fromkeys(other, one)
    return {name: np.mean([points[member] for member in groups[name]], axis=0) for name in points}
