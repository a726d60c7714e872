"""What the grippers take hold of and how they move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import Camera
from polyfold.types import Action

Floats = NDArray[np.float32]

JAW, COVER = 0.015, 0.6
"""A gripper holds the cloth, all layers of it, within its jaw's half width of the pick [m].

On a coarse mesh it reaches this share of the longest edge, and so a pick on the cloth is never empty: no point of a
triangle is farther from its nearest corner than 0.58 of that.
"""
RISING, FALLING, HIGHEST = 0.45, 0.25, 0.30
"""Height of the path's first and second half as shares of the distance from pick to place; upper limit [m].

Lower on the way down: a flap that is laid down taut drags what lies below it along.
"""
LIMP, STIFF = (0.002, 1.5), (0.006, 1.8)
"""Height of the held packet [m] and the shape of its path, of a limp and of a stiff packet.

1 is a triangle, 2 half an ellipse. Limp cloth is best laid down along a flatter path, which takes it across taut, but
not so flat that a long flap, hanging, pulls the cloth below along; the inner plies of a thick packet have cloth to
spare, and coming in flat they push the plies below along.
"""
SPEED, RAMP, HOLD = 0.7, 0.15, 0.05
"""Speed of the gripper [m/s], time to reach it and to stop [s], and pause before it opens [s].

Slower, at 0.5, a limp flap hangs longer over what lies below, and drags it by up to a mesh edge before the crease has
rolled to its line.
"""


@dataclass(frozen=True, eq=False)
class Grasp:
    """The held particles of all arms.

    Attributes:
        particles: indices, uint32, shape (G,).
        arms: which arm holds each, uint32, shape (G,).
        offsets: position relative to the arm's pick point [m], float32, shape (G, 3).
        starts, ends: pick and place points of every arm [m], shape (arms, 3).
        plies: how many each arm holds, shape (arms,); 0 where its grip is empty.
        height: of the thickest held packet, its plies pressed together [m].
        short: how far each arm's end is from the place that was asked for [m], shape (arms,).
    """

    particles: NDArray[np.uint32]
    arms: NDArray[np.uint32]
    offsets: Floats
    starts: NDArray[np.float64]
    ends: NDArray[np.float64]
    plies: NDArray[np.int64]
    height: float
    short: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """A sampled gripper path.

    Attributes:
        path: position of every arm at each substep [m], float32, shape (S, arms, 3).
        turns: cosine and sine of how far the held patch has turned, float32, shape (S, 2).
        directions: horizontal unit vector from pick to place per arm, float32, shape (arms, 2).
    """

    path: Floats
    turns: Floats
    directions: Floats


def take_hold(
    action: Action,
    positions: NDArray[np.float64],
    triangles: NDArray[np.uint32],
    camera: Camera,
    thickness: float,
    longest_edge: float,
) -> Grasp | None:
    """The particles under each pick, all layers above the fingers' tips; None if there are none.

    Args:
        action: picks and places [px], and how deep the fingers go.
        positions: of the particles [m], shape (N, 3).
        triangles: vertex indices, shape (T, 3), by which plies are counted.
        camera: which point of the table a pixel is.
        thickness: of a ply [m].
        longest_edge: of the mesh [m].
    """
    reach = max(JAW, COVER * longest_edge)
    distances = np.empty((action.arms, len(positions)))
    for arm, pick in enumerate(action.picks):
        ray = camera.to_world(pick, positions[:, 2])
        distances[arm] = np.hypot(*(positions - ray)[:, :2].T)
    nearest = distances.argmin(axis=0)
    held = distances.min(axis=0) <= reach
    if action.heights is not None:
        held &= positions[:, 2] >= action.heights[nearest]
    particles = np.flatnonzero(held)
    if len(particles) == 0:
        return None
    arms = nearest[particles]
    starts, ends = np.zeros((action.arms, 3)), np.zeros((action.arms, 3))
    plies = np.zeros(action.arms)
    for arm in range(action.arms):
        mine = positions[particles[arms == arm]]
        level = float(mine[:, 2].mean()) if len(mine) else 0.0
        above = float(mine[:, 2].max()) - level if len(mine) else 0.0
        plies[arm] = _plies(particles[arms == arm], positions, triangles)
        starts[arm] = camera.to_world(action.picks[arm], level)
        target = camera.to_world(action.places[arm], level)
        under = ~held & (np.hypot(*(positions - target)[:, :2].T) <= reach)
        surface = float(positions[under, 2].max()) + thickness if under.any() else thickness / 2
        ends[arm] = camera.to_world(action.places[arm], surface + above)
    return Grasp(
        particles.astype(np.uint32),
        arms.astype(np.uint32),
        (positions[particles] - starts[arms]).astype(np.float32),
        starts,
        ends,
        np.rint(plies).astype(np.int64),
        thickness * float(plies.max()),
        np.zeros(action.arms),
    )


def _plies(held: NDArray[np.int64], positions: NDArray[np.float64], triangles: NDArray[np.uint32]) -> float:
    """How many plies lie over each other where the held particles are, by the median; 0 if nothing is held."""
    if len(held) == 0:
        return 0.0
    a, b, c = (positions[triangles[np.isin(triangles, held).any(axis=1)]][:, k, :2] for k in range(3))
    at = positions[held, None, :2]

    def turn(p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
        (px, py), (qx, qy) = np.moveaxis(p - at, 2, 0), np.moveaxis(q - at, 2, 0)
        return px * qy - py * qx

    turns = np.stack([turn(a, b), turn(b, c), turn(c, a)])
    # A particle lies in all triangles of its own ply that meet at it: six of them count as one.
    own = (turns == 0.0).sum(axis=0) > 0
    inside = ((turns > 0.0).all(axis=0) | (turns < 0.0).all(axis=0)) & ~own
    return 1.0 + float(np.median(inside.sum(axis=1)))


def directions(grasp: Grasp) -> NDArray[np.float64]:
    """Horizontal unit vectors from pick to place, shape (arms, 2); zeros where they are one."""
    span = (grasp.ends - grasp.starts)[:, :2]
    return span / np.maximum(np.hypot(*span.T), 1e-9)[:, None]


def plan_motion(grasp: Grasp, time_step: float) -> Motion:
    """Arcs from pick to place, all arms arriving together, followed by a short hold."""
    span = (grasp.ends - grasp.starts)[:, :2]
    distance = np.hypot(*span.T)
    (low, limp), (high, stiff) = LIMP, STIFF
    swing, lift, length = _arc(float(np.interp(grasp.height, (low, high), (limp, stiff))))
    progress = _eased(float(length[-1] * distance.max()), time_step)
    across = np.interp(progress, length / length[-1], swing)
    up = np.interp(progress, length / length[-1], lift)
    height = np.minimum(distance, HIGHEST / lift.max())
    path = np.empty((len(progress), len(span), 3))
    path[:, :, :2] = grasp.starts[:, :2] + across[:, None, None] * span
    path[:, :, 2] = grasp.starts[:, 2] + progress[:, None] * (grasp.ends - grasp.starts)[:, 2] + up[:, None] * height
    turns = np.stack([np.cos(np.pi * progress), np.sin(np.pi * progress)], axis=1)
    return Motion(path.astype(np.float32), turns.astype(np.float32), directions(grasp).astype(np.float32))


def _arc(roundness: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The path of this shape over a distance of 1: how far across, how high, and the length so far."""
    angle = np.linspace(0.0, np.pi, 401)
    cosine, sine = np.cos(angle), np.sin(angle)
    across = (1.0 - np.sign(cosine) * np.abs(cosine) ** (2 / roundness)) / 2
    up = (RISING + (FALLING - RISING) * across) * sine ** (2 / roundness)
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(across), np.diff(up)))])
    return across, up, length


def _eased(length: float, time_step: float) -> NDArray[np.float64]:
    """Progress from 0 to 1 along a path of ``length`` [m] at full speed with soft ends, then the hold."""
    duration = length / SPEED + RAMP
    times = np.arange(1, max(2, round(duration / time_step)) + 1) * time_step
    ramp = np.clip(np.minimum(times, duration - times) / RAMP, 0.0, 1.0)
    travelled = np.cumsum(ramp * ramp * (3.0 - 2.0 * ramp))
    hold = np.ones(max(1, round(HOLD / time_step)))
    return np.concatenate([travelled / travelled[-1], hold])
