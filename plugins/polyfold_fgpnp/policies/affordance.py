"""Which two points of a flap go best together: the affordance score, its best pair, and the best partner of a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.region import FoldRegion

Floats = NDArray[np.float64]

PARTNER_SLIDE = 0.1
"""How far a second pick moves towards the first along the contour, as a share of their distance; not in the paper."""

GAP_PX = 4.0
"""Neighbours on the contour lie closer than this; a longer step leads over the fold line to another piece."""


def quadrilateral_area(start: ArrayLike, end: ArrayLike, first: ArrayLike, second: ArrayLike) -> Floats:
    """Area of the convex hull of four points [px] that broadcast, shape (..., 2): [px²], shape (...).

    In the order start, end, first, second the outline of two good corners can cross itself and enclose nothing. The
    hull's area is the largest among the areas of the three possible orders and of the four triangles.
    """
    a, b, c, d = (np.asarray(point, float) for point in (start, end, first, second))
    doubled = (
        _cross(c - a, d - b), _cross(b - a, d - c), _cross(d - a, c - b),  # outlines abcd, acbd, abdc
        _cross(b - a, c - a), _cross(b - a, d - a), _cross(c - a, d - a), _cross(c - b, d - b),
    )  # fmt: skip
    largest = np.abs(doubled[0])
    for area in doubled[1:]:
        largest = np.maximum(largest, np.abs(area))
    return largest / 2


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def affordance(region: FoldRegion, first: ArrayLike, second: ArrayLike, gamma: float) -> Floats:
    """The score S / S_max + gamma (l(first) + l(second)) / sqrt(S_max) of pairs of points, shape (...).

    Args:
        region: the flap.
        first, second: the points [px], shape (..., 2), which broadcast.
        gamma: weight of their distances l from the line.
    """
    line = region.fold_line
    areas = quadrilateral_area(line.start, line.end, first, second)
    distances = line.distance(first) + line.distance(second)
    return areas / region.box_area + gamma * distances / np.sqrt(region.box_area)


def best_pair(region: FoldRegion, gamma: float) -> tuple[Floats, Floats]:
    """The two contour pixels [px] with the best affordance score, each of shape (2,); one and the same is possible.

    The score is ``S(start, end, p, q) / S_max + gamma (l(p) + l(q)) / sqrt(S_max)``. It is convex in p and in q, so its
    maximum over all contour pixels is attained at corners of their convex hull: comparing these few is exact.
    """
    points = _hull_corners(region)
    score = affordance(region, points[:, None], points[None, :], gamma)
    first, second = np.unravel_index(int(_first_best(score.ravel())), score.shape)
    return points[first], points[second]


def second_pick(region: FoldRegion, first: ArrayLike, gamma: float) -> Floats:
    """The contour pixels, shape (..., 2), that go best with given first picks [px], shape (..., 2).

    Each maximises ``S(start, end, first, p) / S_max + gamma l(p) / sqrt(S_max)`` over all contour pixels (paper,
    Sec. IV-D); as for :func:`best_pair`, corners of their convex hull are enough.
    """
    points = _hull_corners(region)
    return points[_first_best(affordance(region, np.asarray(first, float)[..., None, :], points, gamma))]


def coupled_pick(region: FoldRegion, first: ArrayLike, config: PickConfig, share: float = PARTNER_SLIDE) -> Floats:
    """The :func:`second_pick` of first picks, moved a little towards them (see :func:`slide`) [px], shape (..., 2).

    Args:
        region: the flap.
        first: the first picks [px], shape (..., 2).
        config: weighs distances in the affordance.
        share: how far to move, as a share of their distance.
    """
    firsts = np.asarray(first, float).reshape(-1, 2)
    partners = second_pick(region, firsts, config.gamma)
    corners, chosen = np.unique(partners, axis=0, return_inverse=True)
    for index, corner in enumerate(corners):  # Many first picks share the few corners.
        mine = chosen.ravel() == index
        partners[mine] = slide(region, corner, firsts[mine], share)
    return partners.reshape(np.shape(first))


def _hull_corners(region: FoldRegion) -> Floats:
    import cv2

    corners = np.asarray(cv2.convexHull(region.points.astype(np.float32), returnPoints=False), np.int32)
    return region.points[np.sort(corners.ravel())]


def _first_best(scores: Floats) -> NDArray[np.int64]:
    """Indices of the highest scores along the last axis; the first one among scores that differ by rounding only."""
    return np.argmax(scores >= scores.max(axis=-1, keepdims=True) - 1e-9, axis=-1)


def slide(region: FoldRegion, pick: ArrayLike, towards: ArrayLike, share: float) -> Floats:
    """Move a contour pixel [px], shape (2,), along the contour towards others, by a share of their distance.

    Where it ends has the shape of ``towards`` [px], (..., 2). Cloth that is held at its outermost corners sags between
    them and the crease; held a little further in, both sides of each pick balance. It stops where the lifted part's
    contour ends.
    """
    pick, towards = np.asarray(pick, float), np.asarray(towards, float)
    distances = share * _length(towards - pick)
    at = int(np.argmin(((region.points - pick) ** 2).sum(1)))
    onwards = np.roll(region.points, -at, axis=0)
    backwards = np.roll(onwards[::-1], 1, axis=0)
    one, other = (_walk(path, distances) for path in (onwards, backwards))
    return np.where((_length(one - towards) <= _length(other - towards))[..., None], one, other)


def _walk(path: Floats, distances: Floats) -> Floats:
    """The points that far along a polyline [px], or the last one before a gap; distances of shape (...)."""
    steps = _length(np.diff(path, axis=0))
    gaps = np.flatnonzero(steps > GAP_PX)
    last = int(gaps[0]) if len(gaps) else len(steps)
    return path[np.minimum(np.searchsorted(np.cumsum(steps), distances + 1e-9, side="right"), last)]


def _length(vectors: Floats) -> Floats:
    return np.hypot(vectors[..., 0], vectors[..., 1])
