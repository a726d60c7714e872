"""Flat outlines with named corners: what a panel is cut from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.geometry import polygon_area

SAMPLES_PER_EDGE = 96


@dataclass(frozen=True, eq=False)
class Outline:
    """The closed silhouette of a garment spread flat and upright.

    Attributes:
        points: the silhouette [m], x right, y up, shape (M, 2), finely sampled, either direction, not repeating its
            first point.
        corners: name -> index into ``points``; these positions become vertices of the mesh exactly.
        openings: pairs of corner names; on the way from the first to the second, in the order of ``points``, front
            and back are not sewn together.
    """

    points: NDArray[np.float64]
    corners: Mapping[str, int]
    openings: tuple[tuple[str, str], ...] = ()

    def counter_clockwise(self) -> Outline:
        """The same outline, running counter-clockwise seen from above."""
        if polygon_area(self.points) > 0:
            return self
        last = len(self.points) - 1
        return Outline(
            self.points[::-1],
            {name: last - index for name, index in self.corners.items()},
            tuple((end, start) for start, end in self.openings),
        )

    def centred(self) -> Outline:
        """The same outline with the middle of its bounding box at the origin."""
        middle = (self.points.min(0) + self.points.max(0)) / 2
        return Outline(self.points - middle, self.corners, self.openings)


def curved_outline(
    corners: Mapping[str, ArrayLike],
    edges: Mapping[tuple[str, str], ArrayLike] | None = None,
    bulges: Mapping[tuple[str, str], float] | None = None,
    rounding: Mapping[str, float] | None = None,
    openings: tuple[tuple[str, str], ...] = (),
) -> Outline:
    """Join named corners by curved edges with softly rounded corners.

    Args:
        corners: name -> position [m], shape (2,), in order around the garment, clockwise seen from above.
        edges: (from, to) of neighbours -> the polyline between them [m], both ends included, shape (K, 2), for edges
            that are no simple arcs.
        bulges: (from, to) of neighbours -> how far the edge's middle lies outside the straight edge [m]; negative is
            inside. Straight where missing.
        rounding: corner name -> how far from the corner [m] the rounding begins. The named corner then lies in the
            middle of the rounded piece.
        openings: as in :class:`Outline`.
    """
    edges, bulges, rounding = edges or {}, bulges or {}, rounding or {}
    names = list(corners)
    sides = []
    for name, following in zip(names, names[1:] + names[:1], strict=True):
        key = (name, following)
        start, end = np.asarray(corners[name], float), np.asarray(corners[following], float)
        side = np.asarray(edges[key], float) if key in edges else _arc(start, end, bulges.get(key, 0.0))
        sides.append(side)
    points: list[NDArray[np.float64]] = []
    indices: dict[str, int] = {}
    count = 0
    for position, name in enumerate(names):
        radius = rounding.get(name, 0.0)
        before, after = sides[position - 1], sides[position]
        piece = _rounded_corner(before, after, radius)
        body = _trimmed(after, radius, rounding.get(names[(position + 1) % len(names)], 0.0))
        indices[name] = count + len(piece) // 2
        points += [piece, body]
        count += len(piece) + len(body)
    return Outline(np.vstack(points), indices, openings).centred()


def _arc(start: NDArray[np.float64], end: NDArray[np.float64], bulge: float) -> NDArray[np.float64]:
    """A shallow parabola from start to end; outside is to the left of a clockwise outline seen with y up."""
    t = np.linspace(0.0, 1.0, SAMPLES_PER_EDGE)[:, None]
    along = end - start
    outward = np.array([-along[1], along[0]]) / np.hypot(*along)
    return start + t * along + 4.0 * bulge * t * (1.0 - t) * outward


def _arc_length(side: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(side, axis=0).T))])


def _point_at(side: NDArray[np.float64], distance: float) -> NDArray[np.float64]:
    position = _arc_length(side)
    return np.array([np.interp(distance, position, side[:, 0]), np.interp(distance, position, side[:, 1])])


def _rounded_corner(before: NDArray[np.float64], after: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """An odd number of points around the corner between two sides; the middle one is the named corner."""
    corner = after[0]
    if radius == 0.0:
        return corner[None]
    for side in (before, after):
        if _arc_length(side)[-1] < 2.0 * radius:
            raise GarmentError(f"a rounding of {radius:.3f} m does not fit an edge; make it smaller or the edge longer")
    entry = _point_at(before, _arc_length(before)[-1] - radius)
    leave = _point_at(after, radius)
    t = np.linspace(0.0, 1.0, 9)[:, None]
    return (1 - t) ** 2 * entry + 2 * t * (1 - t) * corner + t**2 * leave


def _trimmed(side: NDArray[np.float64], first: float, last: float) -> NDArray[np.float64]:
    """The inner points of a side that lie between the roundings of its two ends."""
    position = _arc_length(side)
    slack = 1e-6
    return side[(position > first + slack) & (position < position[-1] - last - slack)]
