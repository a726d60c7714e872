"""Random shooting: of many drags that are drawn, the one after which a model has the cloth nearest to its goal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Lands = Callable[[Floats, Floats], Floats]
"""Picks and places [m], shape (C, 2) each, to where the cloth's points come to lie, shape (C, K, 3)."""

LENGTHS = (0.1, 0.75)
"""Of drags in any direction, as shares of the view's side."""


@dataclass(frozen=True, eq=False)
class Drag:
    """The drag that was found.

    Attributes:
        pick, place: on the table [m], shape (2,).
        cost: how far the cloth lies from its goal then, see :func:`chamfer` [m].
    """

    pick: Floats
    place: Floats
    cost: float


def best_drag(
    lands: Lands, nodes: Floats, goal: Floats, count: int, extent: float, bounds: Floats, rng: np.random.Generator
) -> Drag:
    """The best of ``count`` drags that are drawn.

    Args:
        lands: what a drag leads to.
        nodes: of the cloth [m], shape (K, 3).
        goal: points of what is wanted [m], shape (G, 3).
        count: how many drags are drawn, at least 2.
        extent: side of the view on the table [m].
        bounds: lowest and highest place, shape (2, 2); a place beyond is moved there.
        rng: what draws.
    """
    picks, places = _drawn(nodes, goal, count, extent, rng)
    places = np.clip(places, *bounds)
    costs = np.array([chamfer(ends, goal) for ends in lands(picks, places)])
    best = int(np.argmin(costs))
    return Drag(picks[best], places[best], float(costs[best]))


def chamfer(points: Floats, goal: Floats) -> float:
    """Mean way from each point to the goal's nearest and back [m], of shapes (K, 3) and (G, 3)."""
    from scipy.spatial.distance import cdist

    apart = cdist(points, goal)
    return float(apart.min(0).mean() + apart.min(1).mean())


def _drawn(nodes: Floats, goal: Floats, count: int, extent: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Picks at nodes, and places: of one half anywhere, of the other nodes that the goal leaves bare go where it is."""
    from scipy.spatial import KDTree

    half = count // 2
    anywhere = nodes[rng.integers(len(nodes), size=half), :2]
    angle, length = rng.uniform(0, 2 * np.pi, half), extent * rng.uniform(*LENGTHS, half)
    ways = length[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    bare = np.asarray(KDTree(goal[:, :2]).query(nodes[:, :2])[0]) + 1e-9
    towards = nodes[rng.choice(len(nodes), count - half, p=bare / bare.sum()), :2]
    there = goal[rng.integers(len(goal), size=count - half), :2]
    return np.concatenate([anywhere, towards]), np.concatenate([anywhere + ways, there])
