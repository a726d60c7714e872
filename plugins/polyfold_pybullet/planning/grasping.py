"""Where hands go: poses that take cloth from above, how they are turned, and the arc along which cloth is carried."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

OFFSETS = np.deg2rad([0.0, 20.0, -20.0, 40.0, -40.0, 65.0, -65.0, 90.0])
"""By how much hands may be turned from where they would be best [rad], in the order of trying."""
LEAN = float(np.deg2rad(20))
"""How far a hand leans outwards where one that points straight down does not reach [rad]."""
PAD = 0.009
"""Half of a finger's breadth [m]: where a hand leans, the edge of its fingers is lower than their middle."""
LIFT, HIGHEST = 0.4, 0.25
"""Height of the arc as a share of the way from pick to place; upper limit [m]."""


def top_down(position: ArrayLike, yaw: float) -> Floats:
    """Pose of a tool that points down.

    Args:
        position: of the tool [m], shape (3,).
        yaw: direction of the hand's wide side in the plane of the table, from the x axis [rad].

    Returns:
        Shape (4, 4).
    """
    cosine, sine = np.cos(yaw), np.sin(yaw)
    pose = np.eye(4)
    # Columns: x is y cross z.
    pose[:3, :3] = [[-sine, cosine, 0.0], [cosine, sine, 0.0], [0.0, 0.0, -1.0]]
    pose[:3, 3] = np.asarray(position, float)
    return pose


def wide_sides(picks: Floats, places: Floats) -> Iterator[tuple[float, float]]:
    """How the hands may be turned at picks and places [rad], the best first.

    Best is each hand's wide side perpendicular to the line between the tools, at the picks and at the places, if the
    line turns by at most 60° on the way; else perpendicular to the line half way. One tool alone is best with the wide
    side across its way.

    Args:
        picks, places: on the table [m], shape (arms, 2 or more).
    """
    if len(picks) == 1:
        across = places[0, :2] - picks[0, :2]
        start = end = float(np.arctan2(across[1], across[0]))
    else:
        start, end = (float(np.arctan2(*(points[1, :2] - points[0, :2])[::-1])) for points in (picks, places))
        # A hand turned by half a turn is the same hand.
        end = start + (end - start + np.pi / 2) % np.pi - np.pi / 2
        if abs(end - start) > np.deg2rad(60):
            start = end = (start + end) / 2
    for offset in OFFSETS:
        yield start + np.pi / 2 + offset, end + np.pi / 2 + offset


def away_from(poses: Floats, base: Floats) -> Floats:
    """Directions in the plane of the table from an arm's base, where it stands, to poses: shape (T, 2)."""
    away = poses[:, :2, 3] - base[:2]
    return away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)


def towards_each_other(picks: Floats, places: Floats, rows: int) -> tuple[Floats, Floats]:
    """Directions from each of two tools to the other along their carry: unit vectors, shape (3 * rows, 2) each."""
    start, end = (points[1, :2] - points[0, :2] for points in (picks, places))
    start, end = (way / max(float(np.linalg.norm(way)), 1e-9) for way in (start, end))
    shares = ((1 - np.cos(np.linspace(0, np.pi, rows))) / 2)[:, None]
    between = start * (1 - shares) + end * shares
    first = np.vstack([np.tile(start, (rows, 1)), between, np.tile(end, (rows, 1))])
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-9)
    return first, -first


def leaning(poses: Floats, directions: Floats, angle: float) -> Floats:
    """Poses at the same places of a tool that leans, so that the arm behind it is out of the way or reaches farther.

    Its wide side lies across the direction: of a hand that leans to a side, one finger would be in the table. It is
    raised so that the lower edge of its fingers is as high as their tips were.

    Args:
        poses: of a tool that points down, shape (T, 4, 4).
        directions: unit vectors in the plane of the table, to where fingers point, shape (T, 2).
        angle: by how much it leans [rad].
    """
    leant = np.empty_like(poses)
    for pose, direction, new in zip(poses, directions, leant, strict=True):
        out = np.arctan2(direction[1], direction[0])
        # Of the two ways to hold a two-finger hand, the one nearer to how it was held.
        side = 1.0 if -np.sin(out) * pose[0, 1] + np.cos(out) * pose[1, 1] >= 0 else -1.0
        new[:] = top_down(pose[:3, 3], out + side * np.pi / 2)
        ahead = np.array([*direction, 0.0])
        approach = np.cos(angle) * new[:3, 2] + np.sin(angle) * ahead
        new[:3, 0], new[:3, 2] = np.cross(new[:3, 1], approach), approach
        new[2, 3] += PAD * np.sin(angle)
    return leant


def carried(pick: Floats, place: Floats, yaws: tuple[float, float], hover: float, rows: int) -> Floats:
    """Poses of a tool that goes down on a pick, carries along half an ellipse to the place, and goes up again.

    Args:
        pick, place: [m], shape (3,).
        yaws: at pick and place [rad].
        hover: height above pick and place where it begins and ends [m].
        rows: how many poses each of its three parts has.

    Returns:
        Shape (3 * rows, 4, 4). Each part ends where the next begins.
    """
    up = np.array([0.0, 0.0, hover])
    down = [top_down(pick + (1 - share) * up, yaws[0]) for share in np.linspace(0, 1, rows)]
    height = min(HIGHEST, LIFT * float(np.hypot(*(place - pick)[:2])))
    arc = []
    for angle in np.linspace(0, np.pi, rows):
        share = (1 - np.cos(angle)) / 2
        position = pick + share * (place - pick) + [0.0, 0.0, height * np.sin(angle)]
        arc.append(top_down(position, yaws[0] + share * (yaws[1] - yaws[0])))
    away = [top_down(place + share * up, yaws[1]) for share in np.linspace(0, 1, rows)]
    return np.array([*down, *arc, *away])


def straight(start: Floats, end: Floats, step: float = 0.02) -> Floats:
    """Poses on the straight line from one to another, turning evenly, at most about ``step`` [m] apart, (T, 4, 4)."""
    from scipy.spatial.transform import Rotation, Slerp

    turns = Rotation.from_matrix(np.stack([start[:3, :3], end[:3, :3]]))
    way = float(np.linalg.norm(end[:3, 3] - start[:3, 3])) + 0.1 * float((turns[0].inv() * turns[1]).magnitude())
    shares = np.linspace(0, 1, max(2, int(np.ceil(way / step)) + 1))
    poses = np.tile(np.eye(4), (len(shares), 1, 1))
    poses[:, :3, :3] = Slerp([0, 1], turns)(shares).as_matrix()
    poses[:, :3, 3] = start[:3, 3] + shares[:, None] * (end - start)[:3, 3]
    return poses
