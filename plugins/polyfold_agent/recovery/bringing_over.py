"""How to bring over what one of two arms left behind while the other one pulled it away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from polyfold.geometry import FoldLine, contour_of, turn_onto
from polyfold.types import Action
from polyfold_agent.recovery.attempt import Attempt, Motion
from polyfold_agent.recovery.cloth import Floats, Mask, inside
from polyfold_agent.recovery.expectation import SPECK

FRAGMENT, SLID, ALIKE = 45, 60, 3.0
"""The outline around a corner is compared as far as this to either side; how far along it a corner may have been
mistaken; the distance (root mean square) up to which two pieces of outline are the same piece [points, about px]."""

ALONG = 0.5
"""Where the second arm takes hold, as a share of the edge that still lies left of the line."""

DANGLING = 0.4
"""Share of the edge between two picks that must still lie left of the line for a second arm to help: where little is
left, it would hold the cloth below as well."""


@dataclass(frozen=True, eq=False)
class _Edge:
    """Part of a contour: which way along the contour it runs (1 or -1), and its points [px], shape (N, 2)."""

    step: int
    points: Floats

    @property
    def length(self) -> float:
        """From end to end [px]."""
        return float(_lengths(self.points)[-1])


def bring_over(attempt: Attempt, mask: Mask, arm: int, corner: Floats) -> Action:
    """The fold that brings over what one of two arms left behind and the other one pulled away.

    One arm alone would drag the edge along and bunch the flap. So that arm takes the cloth that it should have taken,
    where it lies now, and the other one takes the edge halfway to the line. As folding keeps lengths along the edge,
    both are known to belong to the original flap's mirror image.

    Args:
        attempt: the fold, moved with the garment.
        mask: the cloth now, bool, shape (H, W).
        arm: which arm took nothing.
        corner: roughly where its cloth lies now [px], shape (2,).
    """
    pick, place = attempt.action.picks[arm], attempt.action.places[arm]
    before, now = contour_of(attempt.mask), contour_of(mask)
    distance, motion = _same_piece(before, now, pick, corner)
    if distance > ALIKE:
        return Action(corner[None], place[None])
    first = inside(mask, motion.points(pick), 1.0)
    edge = _between(before, pick, attempt.action.picks[1 - arm], attempt.line)
    lengths, loose = _left_behind(_from(now, first, edge.step), attempt.line)
    if lengths[-1] < DANGLING * edge.length:
        return Action(corner[None], place[None])
    length = min(ALONG * float(lengths[-1]), edge.length)
    second, origin = inside(mask, _at(loose, length)), inside(attempt.mask, _at(edge.points, length))
    return Action(np.array([first, second]), np.array([place, attempt.line.mirror(origin)]))


def _same_piece(before: Floats, now: Floats, pick: Floats, corner: Floats) -> tuple[float, Motion]:
    """How the outline around a pick was moved to where a corner is now, and how far they still differ [px]."""
    span = np.arange(-FRAGMENT, FRAGMENT + 1)
    found = now[(_nearest(now, corner) + span) % len(now)]
    start = _nearest(before, pick)
    pieces = (before[(start + slid + span) % len(before)] for slid in range(-SLID, SLID + 1, 2))
    return min((_carried(piece, found) for piece in pieces), key=lambda fit: fit[0])


def _carried(points: Floats, goal: Floats) -> tuple[float, Motion]:
    """The rigid motion that lays points [px], shape (N, 2), on others, and the remaining distance [px]."""
    motion = Motion.carrying(points.mean(axis=0), goal.mean(axis=0), turn_onto(points, goal))
    return float(np.sqrt(((motion.points(points) - goal) ** 2).sum(axis=1).mean())), motion


def _between(contour: Floats, pick: Floats, other: Floats, line: FoldLine) -> _Edge:
    """The edge from one pick to the other that stays left of the line, else the shorter one."""
    edges = []
    for step in (1, -1):
        points = _from(contour, pick, step)
        points = points[: _nearest(points, other) + 1]
        crosses = bool((line.distance(points) < -SPECK).any())
        edges.append((crosses, len(points), _Edge(step, points)))
    return min(edges, key=lambda edge: edge[:2])[2]


def _left_behind(edge: Floats, line: FoldLine) -> tuple[Floats, Floats]:
    """The first part of an edge, up to the line: length so far [px], shape (N,), and points, shape (N, 2)."""
    over = np.flatnonzero(line.distance(edge) <= SPECK / 2)
    points = edge[: over[0] + 1] if len(over) else edge
    return _lengths(points), points


def _from(contour: Floats, point: Floats, step: int) -> Floats:
    """A contour begun at the pixel nearest to a point, forwards or backwards."""
    return contour[(_nearest(contour, point) + step * np.arange(len(contour))) % len(contour)]


def _nearest(contour: Floats, point: Floats) -> int:
    return int(np.argmin(((contour - point) ** 2).sum(axis=1)))


def _lengths(points: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _at(points: Floats, length: float) -> Floats:
    """The point at an arc length [px] along a polyline, shape (2,)."""
    lengths = _lengths(points)
    return np.array([np.interp(length, lengths, column) for column in points.T])
