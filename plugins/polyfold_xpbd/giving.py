"""Where arms give way: two that hold the same cloth can't part farther than it reaches, and none tears it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from polyfold_xpbd.grasp import Grasp, directions
from polyfold_xpbd.tethers import Tethers

TURNS_AGAIN = 4
"""How often ends are drawn together: each time the held patches turn another way, and so reach differently."""
TAUT, SLIP = 0.22, 0.25
"""Strain of any edge at which the grippers stand still until the cloth has followed, and of an edge at a grip at which
what is held slips out of it: no ordinary cloth is stretched by more."""
MORE = 0.05
"""How much more than before a fold an edge may be stretched, if that is more than :data:`TAUT`: else cloth that is
stretched where it lies could not be lifted at all."""
ALL = np.full(2, np.inf, np.float32)
"""What :func:`borne` is for grippers that neither give way nor let go."""


def borne(strain: NDArray[np.floating]) -> NDArray[np.float32]:
    """The strains at which grippers stand still and lose what they hold, shape (2,).

    Args:
        strain: of the edges before the fold, shape (E,).
    """
    return np.array([max(TAUT, float(strain.max(initial=0.0)) + MORE), SLIP], np.float32)


def give_way(grasp: Grasp, tethers: Tethers, strain: float) -> Grasp:
    """The same grasp with ends drawn together, evenly, until no cloth between two arms is stretched beyond ``strain``.

    Args:
        grasp: what the arms hold, and where they mean to go.
        tethers: how far the cloth reaches from each arm, see :class:`TetherMap`.
        strain: by how much the cloth may be longer than at rest, as a share.
    """
    arm_of = np.full(1 + max(int(tethers.particles.max(initial=0)), int(grasp.particles.max())), -1)
    place = arm_of.copy()
    arm_of[grasp.particles], place[grasp.particles] = grasp.arms, np.arange(len(grasp.particles))
    between = (arm_of[tethers.particles] >= 0) & (arm_of[tethers.particles] != arm_of[tethers.anchors])
    if not between.any():
        return grasp
    first, second = place[tethers.anchors[between]], place[tethers.particles[between]]
    reach = (1.0 + strain) * tethers.lengths[between].astype(np.float64)
    ends = grasp.ends
    for _ in range(TURNS_AGAIN):
        offsets = _turned(replace(grasp, ends=ends))
        apart = ends[grasp.arms[second]] - ends[grasp.arms[first]]
        share = _share(apart, offsets[second] - offsets[first], reach)
        if share >= 1.0:
            break
        middle = ends.mean(axis=0)
        ends = middle + share * (ends - middle)
    return grasp if ends is grasp.ends else replace(grasp, ends=ends, short=np.linalg.norm(grasp.ends - ends, axis=1))


def _turned(grasp: Grasp) -> NDArray[np.float64]:
    """Offsets of the held particles from their arm's place once it has arrived there [m], shape (G, 3)."""
    ahead = directions(grasp)[grasp.arms]
    offsets = grasp.offsets.astype(float)
    offsets[:, :2] -= 2 * (offsets[:, :2] * ahead).sum(axis=1, keepdims=True) * ahead
    offsets[:, 2] *= -1
    return offsets


def _share(apart: NDArray[np.float64], beside: NDArray[np.float64], reach: NDArray[np.float64]) -> float:
    """The largest share of the arms' distances, 0 to 1, at which every pair of particles is within its reach.

    Args:
        apart: vector between a pair's arms [m], shape (K, 3).
        beside: what the particles' offsets from their arms add to it [m], shape (K, 3).
        reach: of the cloth between the pair [m], shape (K,).
    """
    a, b = np.maximum((apart**2).sum(axis=1), 1e-12), (apart * beside).sum(axis=1)
    room = reach**2 - (beside**2).sum(axis=1)
    shares = np.where(room > 0.0, (np.sqrt(b * b + a * np.maximum(room, 0.0)) - b) / a, 0.0)
    return float(np.clip(shares.min(), 0.0, 1.0))
