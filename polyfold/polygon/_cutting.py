"""Cutting a labelled polygon along a line into the pieces on either side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import polygon_area

_COINCIDE = 1e-7

_SAME_VERTEX = 2.0
"""A line that passes a named corner this closely [px] is taken to run through it: both sides then keep the name."""


@dataclass(frozen=True, eq=False)
class LabelledPolygon:
    """A simple polygon with names at its corners.

    Attributes:
        points: corners [px], shape (N, 2).
        names: names at each corner.
        edges: a label for the edge that follows each corner.
    """

    points: NDArray[np.float64]
    names: tuple[tuple[str, ...], ...]
    edges: tuple[str, ...]


@dataclass(frozen=True)
class _Crossing:
    """Where the polygon passes from one side of the line to the other."""

    edge: int
    point: NDArray[np.float64]
    along: float
    leaves_left: bool
    names: tuple[str, ...]


def cut(
    polygon: LabelledPolygon, distance: NDArray[np.float64], direction: NDArray[np.float64], label: str
) -> tuple[list[LabelledPolygon], list[LabelledPolygon]]:
    """Split along a line.

    Args:
        polygon: it need not be convex and may fall into several pieces.
        distance: signed distance [px] of its corners from the line, positive on the left, shape (N,).
        direction: unit vector along the line, shape (2,).
        label: the label of the new edges along the line.

    Returns:
        Pieces on the left and on the right. A named corner on the line is a corner of every piece it touches.
    """
    left = distance > _COINCIDE
    crossings = _crossings(polygon, distance, left, direction)
    if not crossings:
        return ([polygon], []) if left.all() else ([], [polygon])
    partner = _partners(crossings, clockwise=polygon_area(polygon.points) > 0)
    pieces: tuple[list[LabelledPolygon], list[LabelledPolygon]] = ([], [])
    for begin_left in (True, False):
        # On its way round, a piece follows the polygon from one crossing to the next, then the line to the partner.
        unused = {k for k, c in enumerate(crossings) if c.leaves_left != begin_left}
        while unused:
            piece, first = _Builder(), min(unused)
            k = first
            while k in unused:
                unused.discard(k)
                following = (k + 1) % len(crossings)
                piece.follow(polygon, crossings[k], crossings[following], label)
                k = partner[following]
            made = piece.finish()
            if made is not None:
                pieces[0 if begin_left else 1].append(made)
    return pieces


def _crossings(
    polygon: LabelledPolygon, distance: NDArray[np.float64], left: NDArray[np.bool_], direction: NDArray[np.float64]
) -> list[_Crossing]:
    found, count = [], len(distance)
    for i in range(count):
        j = (i + 1) % count
        if left[i] == left[j]:
            continue
        share = distance[i] / (distance[i] - distance[j])
        point = polygon.points[i] + np.clip(share, 0.0, 1.0) * (polygon.points[j] - polygon.points[i])
        nearest = i if share < 0.5 else j
        close = np.hypot(*(polygon.points[nearest] - point)) < _SAME_VERTEX
        names = polygon.names[nearest] if close else ()
        found.append(_Crossing(i, point, float(point @ direction), bool(left[i]), names))
    return found


def _partners(crossings: list[_Crossing], clockwise: bool) -> list[int]:
    """Pair the crossings that bound a stretch of the line inside the polygon.

    Along the line, passing to the left and to the right alternate, and the polygon's orientation says which is first;
    that decides the order where crossings coincide (the line touches a corner).
    """
    order = sorted(range(len(crossings)), key=lambda k: crossings[k].along)
    leaves_left = not clockwise
    arranged: list[int] = []
    while order:
        near = [k for k in order if crossings[k].along - crossings[order[0]].along < _COINCIDE]
        chosen = next((k for k in near if crossings[k].leaves_left == leaves_left), order[0])
        arranged.append(chosen)
        order.remove(chosen)
        leaves_left = not leaves_left
    partner = [0] * len(crossings)
    for a, b in zip(arranged[::2], arranged[1::2], strict=True):
        partner[a], partner[b] = b, a
    return partner


class _Builder:
    """Collects the corners of one piece, merging those that coincide."""

    def __init__(self) -> None:
        self.points: list[NDArray[np.float64]] = []
        self.names: list[tuple[str, ...]] = []
        self.edges: list[str] = []
        self._shared: list[tuple[NDArray[np.float64], tuple[str, ...]]] = []

    def follow(self, polygon: LabelledPolygon, begin: _Crossing, end: _Crossing, label: str) -> None:
        count = len(polygon.points)
        self._shared += [(crossing.point, crossing.names) for crossing in (begin, end)]
        self._add(begin.point, (), polygon.edges[begin.edge])
        k, steps = (begin.edge + 1) % count, (end.edge - begin.edge) % count or count
        for _ in range(steps):
            self._add(polygon.points[k], polygon.names[k], polygon.edges[k])
            k = (k + 1) % count
        self._add(end.point, (), label)

    def finish(self) -> LabelledPolygon | None:
        if len(self.points) > 1 and _same(self.points[0], self.points[-1]):
            self.names[0] = tuple(dict.fromkeys(self.names[-1] + self.names[0]))
            for part in (self.points, self.names, self.edges):
                part.pop()
        if len(self.points) < 3:
            return None
        for point, names in self._shared:
            missing = tuple(name for name in names if not any(name in known for known in self.names))
            corner = int(np.argmin([np.abs(p - point).max() for p in self.points]))
            self.names[corner] += missing
        return LabelledPolygon(np.array(self.points), tuple(self.names), tuple(self.edges))

    def _add(self, point: NDArray[np.float64], names: tuple[str, ...], edge: str) -> None:
        if self.points and _same(self.points[-1], point):
            self.names[-1] = tuple(dict.fromkeys(self.names[-1] + names))
            self.edges[-1] = edge
        else:
            self.points.append(point)
            self.names.append(names)
            self.edges.append(edge)


def _same(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    return bool(abs(a[0] - b[0]) < 1e-6 and abs(a[1] - b[1]) < 1e-6)
