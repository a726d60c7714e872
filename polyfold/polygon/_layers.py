"""Facets: the flat pieces that a folded garment consists of, and how one fold cuts, mirrors and stacks them.

This is the one place that folds polygons: the model of the grounding and the ideal result both use it. They differ in
how they count layers. The model lays the whole lifted stack on top of all that remains; the ideal
(:mod:`polyfold.tasks`) lets each piece down onto what lies below it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, polygon_area
from polyfold.polygon._cutting import LabelledPolygon, cut

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
        motion: affine map from the flat garment to here [px], shape (2, 3).
    """

    polygon: Floats
    names: tuple[tuple[str, ...], ...]
    edges: tuple[str, ...]
    layer: int
    flipped: bool
    motion: Floats

    @classmethod
    def flat(cls, polygon: Floats, names: Sequence[str] = (), layer: int = 0) -> Facet:
        """A piece that has not been folded.

        Args:
            polygon: corners [px], shape (N, 2).
            names: the name of the vertex at each corner; without names no corner has one.
            layer: 0 lies on the table.
        """
        labels = tuple((name,) for name in names) or ((),) * len(polygon)
        return cls(polygon, labels, ("",) * len(polygon), layer, False, np.column_stack([np.eye(2), np.zeros(2)]))

    @property
    def area(self) -> float:
        """Area [px²]."""
        return abs(polygon_area(self.polygon))

    def at_rest(self, points: Floats) -> Floats:
        """Where points of the piece [px], shape (..., 2), lay on the flat garment."""
        return (points - self.motion[:, 2]) @ self.motion[:, :2]

    def turned_over(self, line: FoldLine, layer: int) -> Facet:
        """The same piece mirrored across a fold line, in another layer."""
        origin = line.mirror(np.zeros(2))
        turned = [line.mirror(column) for column in self.motion.T]
        motion = np.column_stack([turned[0] - origin, turned[1] - origin, turned[2]])
        polygon = line.mirror(self.polygon)
        return replace(self, polygon=polygon, layer=layer, flipped=not self.flipped, motion=motion)


def cut_facets(
    facets: Iterable[Facet], line: FoldLine, least_area: float = 0.0
) -> tuple[tuple[Facet, ...], tuple[Facet, ...]]:
    """Cut facets along a fold line.

    Args:
        facets: the pieces before the cut.
        line: the fold line [px].
        least_area: smaller pieces [px²] are dropped.

    Returns:
        The pieces on the lifted side and the remaining ones, each where and in the layer it was.
    """
    lifted: list[Facet] = []
    remaining: list[Facet] = []
    direction = np.subtract(line.end, line.start) / line.length
    for facet in facets:
        whole = LabelledPolygon(facet.polygon, facet.names, facet.edges)
        left, right = cut(whole, line.distance(facet.polygon), direction, CREASE)
        for side, pieces in ((lifted, left), (remaining, right)):
            found = (replace(facet, polygon=p.points, names=p.names, edges=p.edges) for p in pieces)
            side.extend(piece for piece in found if piece.area >= least_area)
    return tuple(lifted), tuple(remaining)


def fold_facets(facets: Sequence[Facet], line: FoldLine, number: int, allowance: float = 0.0) -> tuple[Facet, ...]:
    """Lift what lies left of a fold line, mirror it and lay it on top of all that remains.

    Args:
        facets: the pieces before the fold.
        line: the fold line [px].
        number: which fold this is, from 1; names the crease's ends ``fold{number}_start`` and ``fold{number}_end``.
        allowance: how much cloth across the line [px] the bend uses up, half of it on either side: the crease's edge
            then lies that half short of the line. Negative where a thick packet's outer plies stand out beyond it.

    Returns:
        The pieces after the fold; those under :data:`LEAST_AREA` are dropped.

    Raises:
        PlanError: if the line is too short or leaves all cloth on one side.
    """
    if not line.length >= LEAST_LENGTH:
        raise PlanError(
            f"the fold line is {line.length:.0f} px long, so its direction is uncertain; choose two points at least "
            f"{LEAST_LENGTH:.0f} px apart (vertices brought together by a fold coincide: use the crease's ends)"
        )
    above, below = line.shifted(allowance / 2), line.shifted(-allowance / 2)
    lifted, remaining = cut_facets(facets, above, LEAST_AREA)[0], cut_facets(facets, below, LEAST_AREA)[1]
    _check_sides(lifted, remaining)
    if allowance < 0.0:
        # The strip between the two cuts belongs to both sides; a vertex in it, only to its own.
        lifted = tuple(_without_names(piece, line.distance(piece.polygon) < 0.0) for piece in lifted)
        remaining = tuple(_without_names(piece, line.distance(piece.polygon) > 0.0) for piece in remaining)
    # Each side by itself: across a corner, the two cuts are of different lengths.
    lifted, remaining = _name_crease(lifted, above, number), _name_crease(remaining, below, number)
    top = max(facet.layer for facet in remaining) + 1 + max(facet.layer for facet in lifted)
    return (*remaining, *(facet.turned_over(line, top - facet.layer) for facet in lifted))


def plies_at(facets: Iterable[Facet], line: FoldLine) -> float:
    """How many layers a fold along a line would bend, on average along the crease; 0 if it crosses no cloth."""
    lifted, _ = cut_facets(facets, line)
    start, along = np.asarray(line.start), np.subtract(line.end, line.start) / line.length
    bent, reach = 0.0, []
    for piece in lifted:
        on = _on_crease(piece, line)
        if on.any():
            ends = (piece.polygon[on] - start) @ along
            bent += float(np.ptp(ends))
            reach += [ends.min(), ends.max()]
    return bent / float(np.ptp(reach)) if reach and np.ptp(reach) > 0.0 else 0.0


def _check_sides(lifted: Sequence[Facet], remaining: Sequence[Facet]) -> None:
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


def _without_names(piece: Facet, corners: NDArray[np.bool_]) -> Facet:
    names = tuple(() if bare else known for known, bare in zip(piece.names, corners, strict=True))
    return replace(piece, names=names)


def _name_crease(pieces: Sequence[Facet], line: FoldLine, number: int) -> list[Facet]:
    """Name the outermost ends of the new crease, cut along ``line``, in every piece of one side that reaches them."""
    direction = np.subtract(line.end, line.start) / line.length
    start = np.asarray(line.start)
    along = [np.where(_on_crease(piece, line), (piece.polygon - start) @ direction, np.nan) for piece in pieces]
    reach = np.concatenate(along)
    if not np.isfinite(reach).any():
        return list(pieces)
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
    return named


def _on_crease(piece: Facet, line: FoldLine) -> NDArray[np.bool_]:
    """Corners at which a crease edge on this very line begins or ends."""
    crease = np.array([label == CREASE for label in piece.edges])
    near = np.abs(line.distance(piece.polygon)) < 1e-6
    edge = crease & near & np.roll(near, -1)
    return edge | np.roll(edge, 1)
