"""Pure plane geometry on pixel or metre coordinates; numpy arrays in, numpy arrays out.

Everything here takes points as float arrays of shape (N, 2). The convention of the whole project is decided by
:func:`signed_distance`: with y pointing down, as in an image, the side to the LEFT of a directed line is positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]


def signed_distance(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> Points:
    """Distance from the directed line ``start -> end``, positive on its LEFT as seen in an image (y down).

    This is the one place that decides which side of a fold line is lifted: ``cross(end - start, p - start) < 0``.
    It holds in pixel coordinates only; world coordinates (y up) must be converted first.

    Args:
        points: positions, shape (..., 2).
        start, end: two distinct points on the line, shape (2,).

    Returns:
        Distances in the unit of the input, shape (...,).

    Raises:
        ValueError: if start and end coincide.
    """
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = end - start
    length = float(np.hypot(*along))
    if length == 0.0:
        raise ValueError("a line needs two distinct points; start and end coincide")
    offset = np.asarray(points, float) - start
    return (along[1] * offset[..., 0] - along[0] * offset[..., 1]) / length


def left_of(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> NDArray[np.bool_]:
    """Which points [px], shape (..., 2), lie strictly to the left of the directed line, bool, shape (...,)."""
    return signed_distance(points, start, end) > 0.0


def mirror(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> Points:
    """Points reflected across a line; all coordinates in one unit.

    Args:
        points: positions, shape (..., 2).
        start, end: two distinct points on the line, shape (2,).

    Returns:
        The reflected positions, shape (..., 2).
    """
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = end - start
    left_normal = np.array([along[1], -along[0]]) / np.hypot(*along)
    distance = signed_distance(points, start, end)
    return np.asarray(points, float) - 2.0 * distance[..., None] * left_normal


def perpendicular_bisector(pick: ArrayLike, place: ArrayLike) -> tuple[Points, Points]:
    """Directed line (start, end) that mirrors ``pick`` onto ``place`` [px], with ``pick`` on its left; all shape (2,).

    The returned segment is as long as the distance from pick to place and centred between them.
    """
    pick, place = np.asarray(pick, float), np.asarray(place, float)
    middle, toward = (pick + place) / 2, place - pick
    if not np.hypot(*toward) > 0:
        raise ValueError("pick and place coincide; a fold line needs two distinct points")
    half = np.array([toward[1], -toward[0]]) / 2
    start, end = middle - half, middle + half
    return (start, end) if signed_distance(pick, start, end) > 0 else (end, start)


def rotate(points: ArrayLike, angle: float, centre: ArrayLike = (0.0, 0.0)) -> Points:
    """Turn points about a centre; all coordinates in one unit.

    Args:
        points: positions, shape (..., 2).
        angle: the turn [rad]; x towards y is positive (clockwise on screen, y down).
        centre: what stays in place, shape (2,).

    Returns:
        The turned positions, shape (..., 2).
    """
    c, s = np.cos(angle), np.sin(angle)
    centre = np.asarray(centre, float)
    return (np.asarray(points, float) - centre) @ np.array([[c, s], [-s, c]]) + centre


def turn_onto(points: ArrayLike, targets: ArrayLike) -> float:
    """The angle [rad] for :func:`rotate` that, about their centroid, brings points nearest to corresponding targets.

    Least squares after both centroids are laid on each other (Kabsch in the plane; DOI 10.1107/S0567739476001873).

    Args:
        points: positions, shape (N, 2).
        targets: where each should come to lie, in the same unit, shape (N, 2).
    """
    points, targets = np.asarray(points, float), np.asarray(targets, float)
    a, b = points - points.mean(axis=0), targets - targets.mean(axis=0)
    return float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))


def polygon_area(polygon: ArrayLike) -> float:
    """Signed area, in the square of its unit, of a closed polygon, shape (N, 2); positive if it runs from x to y."""
    x, y = np.asarray(polygon, float).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def resample(polyline: ArrayLike, count: int, closed: bool = True) -> Points:
    """``count`` points, shape (count, 2), spaced evenly by arc length along a polyline, shape (N, 2), in its unit."""
    points = np.asarray(polyline, float)
    if closed:
        points = np.vstack([points, points[:1]])
    lengths = np.hypot(*np.diff(points, axis=0).T)
    position = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.linspace(0.0, position[-1], count, endpoint=not closed)
    return np.column_stack([np.interp(at, position, points[:, 0]), np.interp(at, position, points[:, 1])])


def chamfer(a: ArrayLike, b: ArrayLike) -> float:
    """Symmetric Chamfer distance of two sets of points, ½ D(a, b) + ½ D(b, a), D the mean nearest distance.

    Args:
        a: positions, shape (N, 2).
        b: positions in the same unit, shape (M, 2).

    Returns:
        The distance in that unit (paper, Sec. III).
    """
    from scipy.spatial import KDTree

    a, b = np.asarray(a, float), np.asarray(b, float)
    return 0.5 * float(KDTree(b).query(a)[0].mean()) + 0.5 * float(KDTree(a).query(b)[0].mean())
