"""Picks and places of one fold, reasoned from the points that are shown, for planners without a pick policy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import FoldLine
from polyfold_rules.shapes.parts import NotUnderstoodError

Floats = NDArray[np.float64]

_ON_LINE = 3.0
"""Points nearer to the fold line than this [px] don't move."""

_BESIDE = 0.3
"""Points less than this share as far from the line as the farthest one are on slivers beside the part that is meant."""

_INSET = 4.0
"""How far inside the part that moves to grasp [px]: points at its very edge may lie beside the cloth."""

_ONE_ARM = 20.0
"""Two arms nearer than this [px] are one."""

_SLIDE = 0.1
"""Share of their distance that two picks at the ends of one edge move together: cloth held at its very corners sags."""

_DEPTH = 0.04
"""Weight of the picks' distance to the line against the area that they and the line hold taut."""

_BALANCE = 0.5
"""Weight of a single pick's offset from the middle of the part against its distance to the line."""


@dataclass(frozen=True, eq=False)
class Points:
    """Points of the cloth as it lies, and which of them an edge joins.

    Attributes:
        names: what to call them.
        positions: where they are [px], shape (N, 2).
        edges: pairs of indices.
        size: (width, height) of the image [px].
    """

    names: tuple[str, ...]
    positions: Floats
    edges: tuple[tuple[int, int], ...]
    size: tuple[int, int]

    @classmethod
    def of_polygon(cls, positions: Mapping[str, Floats], outlines: Mapping[str, Any], size: tuple[int, int]) -> Points:
        """Vertices by name with the outlines of every layer's pieces.

        Args:
            positions: name -> position [px], shape (2,).
            outlines: layer -> pieces, each the names of the vertices around it.
            size: (width, height) of the image [px].
        """
        names = tuple(positions)
        index = {name: i for i, name in enumerate(names)}
        loops = [[index[name] for name in piece if name in index] for layer in outlines.values() for piece in layer]
        joined = {pair for loop in loops for pair in zip(loop, loop[1:] + loop[:1], strict=True) if len(loop) > 1}
        return cls(names, np.array([positions[name] for name in names]), tuple(sorted(joined)), size)

    @classmethod
    def of_outline(cls, names: Iterable[str], positions: Floats, size: tuple[int, int]) -> Points:
        """Points in order along an outline: neighbours are joined.

        Args:
            names: what to call them.
            positions: where they are [px], shape (N, 2).
            size: (width, height) of the image [px].
        """
        count = len(positions)
        return cls(tuple(names), np.asarray(positions), tuple((i, (i + 1) % count) for i in range(count)), size)


@dataclass(frozen=True, eq=False)
class Motion:
    """Picks and places [px], each of shape (arms, 2), and how they were found."""

    picks: Floats
    places: Floats
    reasoning: str


def motion_for(line: FoldLine, points: Points, arms: int) -> Motion:
    """What one arm, or two, do to fold the cloth along a line.

    Args:
        line: the directed line that the part turns about.
        points: the cloth.
        arms: 1, or 2 for at most two.

    Raises:
        NotUnderstoodError: if none of the points moves.
    """
    distance = line.distance(points.positions)
    moving = np.flatnonzero(distance > max(_ON_LINE, _BESIDE * float(distance.max())))
    if len(moving) == 0:
        raise NotUnderstoodError("none of the points lies on the part that should move")
    crease = _crease(line, points)
    inside = np.vstack([points.positions[moving], crease]).mean(0)
    pair = _pair(line, points, moving, crease) if arms == 2 else None
    picks, said = _two(pair, points) if pair else _single(line, points, moving, inside)
    picks = np.array([_inset(pick, inside) for pick in picks])
    places = _inside_image(picks, line.mirror(picks), points.size)
    way = "; ".join(f"from {_say(pick)} to {_say(place)}" for pick, place in zip(picks, places, strict=True))
    return Motion(
        picks,
        places,
        f"{said} A pick goes where that fold puts it, a few pixels inside the edge so that cloth is grasped: {way}.",
    )


def _say(point: Floats) -> str:
    return f"({point[0]:.0f}, {point[1]:.0f})"


def _crease(line: FoldLine, points: Points) -> Floats:
    """Where the line enters and leaves the cloth [px], shape (2, 2)."""
    distance = line.distance(points.positions)
    found = [points.positions[i] for i in np.flatnonzero(np.abs(distance) <= _ON_LINE)]
    for i, j in points.edges:
        if distance[i] * distance[j] < 0:
            share = distance[i] / (distance[i] - distance[j])
            found.append(points.positions[i] + share * (points.positions[j] - points.positions[i]))
    if not found:
        found = [np.asarray(line.start), np.asarray(line.end)]
    level = _along(line, np.array(found))
    return np.array([found[int(np.argmin(level))], found[int(np.argmax(level))]])


def _along(line: FoldLine, points: Floats) -> Floats:
    """Coordinate along the line [px]."""
    return (points - np.asarray(line.start)) @ (np.subtract(line.end, line.start) / line.length)


def _pair(line: FoldLine, points: Points, moving: NDArray[np.int64], crease: Floats) -> tuple[int, int] | None:
    """The two points that hold the most cloth taut between them and the crease; None if one arm does as well."""
    where = points.positions
    scale = max(float(np.hypot(*(crease[1] - crease[0]))), 1.0)

    def held(pair: tuple[int, int]) -> float:
        p, q = where[list(pair)]
        return _hull_area(np.array([*crease, p, q])) / scale + _DEPTH * float(line.distance(where[list(pair)]).sum())

    pairs = [(int(i), int(j)) for i, j in combinations(moving, 2) if np.hypot(*(where[i] - where[j])) >= _ONE_ARM]
    best = max(pairs, key=held, default=None)
    lone = int(moving[int(np.argmax(line.distance(where[moving])))])
    if best is None or held(best) < 1.02 * held((lone, lone)):
        return None
    return best


def _hull_area(points: Floats) -> float:
    """Area of the convex hull of four points [px²]: the largest of their outlines and triangles."""
    orders = [(0, 1, 2, 3), (0, 2, 1, 3), (0, 1, 3, 2), (0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
    return max(abs(_signed_area(points[list(order)])) for order in orders)


def _signed_area(polygon: Floats) -> float:
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _two(pair: tuple[int, int], points: Points) -> tuple[Floats, str]:
    first, second = points.positions[list(pair)]
    if pair in points.edges or pair[::-1] in points.edges:
        way = second - first
        first, second = first + _SLIDE * way, second - _SLIDE * way
    names = f"{points.names[pair[0]]} {_say(first)} and {points.names[pair[1]]} {_say(second)}"
    return np.array([first, second]), f"Both arms hold the part taut by its outer corners, near {names}."


def _single(line: FoldLine, points: Points, moving: NDArray[np.int64], inside: Floats) -> tuple[Floats, str]:
    """The corner, or the middle of the edge, that moves far and takes the part along evenly."""
    where = points.positions
    candidates = [(where[i], points.names[i]) for i in moving]
    for i, j in points.edges:
        if i in moving and j in moving:
            candidates.append(
                ((where[i] + where[j]) / 2, f"the middle between {points.names[i]} and {points.names[j]}")
            )
    middle = float(_along(line, inside[None])[0])
    spots = np.array([spot for spot, _ in candidates])
    merit = line.distance(spots) - _BALANCE * np.abs(_along(line, spots) - middle)
    spot, name = candidates[int(np.argmax(merit))]
    return spot[None], f"One arm takes the part along best at {name} {_say(spot)}."


def _inset(pick: Floats, inside: Floats) -> Floats:
    way = inside - pick
    length = float(np.hypot(*way))
    return pick + min(_INSET, length / 2) * way / max(length, 1e-9)


def _inside_image(picks: Floats, places: Floats, size: tuple[int, int]) -> Floats:
    """Places drawn back towards their picks, all by the same share, until they lie in the image."""
    limit = np.array(size, float) - 1.0
    way = places - picks
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(way > 0, (limit - picks) / way, np.where(way < 0, -picks / way, np.inf))
    return picks + min(1.0, float(reach.min())) * way
