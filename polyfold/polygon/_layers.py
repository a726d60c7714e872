"""Facets: the flat pieces that a folded garment consists of, and how one fold cuts, mirrors and stacks them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import mirror, polygon_area, signed_distance
from polyfold.polygon._cutting import Outline, cut

Floats = NDArray[np.float64]

LEAST_LENGTH = 10.0
"""Shortest fold line that has a trustworthy direction [px]."""

LEAST_AREA = 15.0
"""Smaller pieces [px²] are dropped, and a fold that lifts or leaves less is none."""

CREASE = "crease"

_SAME_END = 2.0
"""Stacked layers end a crease within this distance of each other [px]."""


@dataclass(frozen=True, eq=False)
class Facet:
    """One flat piece of cloth.

    Attributes:
        polygon: corners [px], shape (N, 2).
        names: names of the vertices at each corner; mostly one or none.
        edges: label of the edge from each corner to the next: ``crease`` or empty.
        layer: 0 lies on the table; higher lies further up.
        flipped: the reverse side is up.
        motion: affine map from the flat garment to here, shape (2, 3).
    """

    polygon: NDArray[np.float64]
    names: tuple[tuple[str, ...], ...]
    edges: tuple[str, ...]
    layer: int
    flipped: bool
    motion: NDArray[np.float64]

    @property
    def area(self) -> float:
        """Area [px²]."""
        return abs(polygon_area(self.polygon))


def fold_facets(facets: Sequence[Facet], start: Floats, end: Floats, number: int) -> tuple[Facet, ...]:
    """Lift what lies left of ``start -> end``, mirror it and lay it on top.

    Args:
        facets: the pieces before the fold.
        start, end: fold line [px], shape (2,).
        number: which fold this is, from 1; names the crease's ends ``fold{number}_start`` and ``fold{number}_end``.

    Returns:
        The pieces after the fold; those under :data:`LEAST_AREA` are dropped.

    Raises:
        PlanError: if the line is too short or leaves all cloth on one side.
    """
    start, end = np.asarray(start, float), np.asarray(end, float)
    length = float(np.hypot(*(end - start)))
    if not length >= LEAST_LENGTH:
        raise PlanError(
            f"the fold line is {length:.0f} px long, so its direction is uncertain; choose two points at least "
            f"{LEAST_LENGTH:.0f} px apart (vertices brought together by a fold coincide: use the crease's ends)"
        )
    lifted, remaining = _cut_all(facets, start, end)
    _check_sides(lifted, remaining)
    lifted, remaining = _name_crease(lifted, remaining, start, end, number)
    top = max(facet.layer for facet in remaining) + 1 + max(facet.layer for facet in lifted)
    return (*remaining, *(_turn_over(facet, start, end, top - facet.layer) for facet in lifted))


def _cut_all(facets: Sequence[Facet], start: Floats, end: Floats) -> tuple[list[Facet], list[Facet]]:
    lifted: list[Facet] = []
    remaining: list[Facet] = []
    direction = (end - start) / np.hypot(*(end - start))
    for facet in facets:
        distance = signed_distance(facet.polygon, start, end)
        left, right = cut(Outline(facet.polygon, facet.names, facet.edges), distance, direction, CREASE)
        for side, pieces in ((lifted, left), (remaining, right)):
            found = (replace(facet, polygon=p.points, names=p.names, edges=p.edges) for p in pieces)
            side.extend(piece for piece in found if piece.area >= LEAST_AREA)
    return lifted, remaining


def _check_sides(lifted: list[Facet], remaining: list[Facet]) -> None:
    if not lifted:
        raise PlanError(
            "all cloth lies right of the fold line, so nothing would be lifted; move the line onto the cloth, or swap "
            "its start and end"
        )
    if not remaining:
        raise PlanError(
            "all cloth lies left of the fold line, so it would be turned over instead of folded; move the line onto "
            "the cloth, or swap its start and end"
        )


def _name_crease(
    lifted: list[Facet], remaining: list[Facet], start: Floats, end: Floats, number: int
) -> tuple[list[Facet], list[Facet]]:
    """Name the outermost ends of the new crease in every piece that reaches them."""
    direction = (end - start) / np.hypot(*(end - start))
    pieces = [*lifted, *remaining]
    along = [np.where(_on_crease(piece, start, end), (piece.polygon - start) @ direction, np.nan) for piece in pieces]
    reach = np.concatenate(along)
    first, last = np.nanmin(reach), np.nanmax(reach)
    named = []
    for piece, position in zip(pieces, along, strict=True):
        names = list(piece.names)
        for end_name, target in ((f"fold{number}_start", first), (f"fold{number}_end", last)):
            if np.isfinite(position).any():
                nearest = int(np.nanargmin(np.abs(position - target)))
                if abs(position[nearest] - target) <= _SAME_END:
                    names[nearest] = (*names[nearest], end_name)
        named.append(replace(piece, names=tuple(names)))
    return named[: len(lifted)], named[len(lifted) :]


def _on_crease(piece: Facet, start: Floats, end: Floats) -> NDArray[np.bool_]:
    """Corners at which a crease edge on this very line begins or ends."""
    crease = np.array([label == CREASE for label in piece.edges])
    near = np.abs(signed_distance(piece.polygon, start, end)) < 1e-6
    edge = crease & near & np.roll(near, -1)
    return edge | np.roll(edge, 1)


def _turn_over(facet: Facet, start: Floats, end: Floats, layer: int) -> Facet:
    origin = mirror(np.zeros(2), start, end)
    turned = [mirror(column, start, end) for column in facet.motion.T]
    motion = np.column_stack([turned[0] - origin, turned[1] - origin, turned[2]])
    polygon = mirror(facet.polygon, start, end)
    return replace(facet, polygon=polygon, layer=layer, flipped=not facet.flipped, motion=motion)
