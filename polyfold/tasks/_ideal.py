"""The ideal fold: the true flat garment folded geometrically, and how near a simulated result came to it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh
from polyfold.geometry import Camera, FoldLine, fill_polygon, iou, mirror
from polyfold.types import SimState

if TYPE_CHECKING:
    import shapely
from polyfold.types._fidelity import Fidelity, Reference

LAYER_THICKNESS = 0.0035
"""Height of one layer of cloth [m], as thick as the ``xpbd`` simulator makes it by default."""


MOVED = 0.020
"""Particles that the ideal moves further than this [m] count as moved."""


TOUCHING = 9.0
"""Facets that overlap by less than this [px²] do not lie on each other."""


Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class IdealFold:
    """The garment after ideal folds.

    Attributes:
        positions: where each particle ends [m], shape (N, 3).
        layer: how many layers of cloth lie under each particle, shape (N,).
        mask: the silhouette as the camera sees it, bool, shape (H, W).
        area: silhouette on the table [px²].
    """

    positions: Floats
    layer: NDArray[np.int64]
    mask: NDArray[np.bool_]
    area: float


@dataclass(frozen=True, eq=False)
class _Facet:
    """A flat piece of cloth: its polygon [px, as if on the table] and how many layers lie under it."""

    polygon: shapely.Geometry
    layer: int


def fold_ideally(
    flat: SimState, mesh: Mesh, lines: Sequence[FoldLine], layer_thickness: float = LAYER_THICKNESS
) -> IdealFold:
    """Fold the flat garment along lines: everything left of a line is mirrored across it, as one rigid stack.

    Args:
        flat: the state before the first fold.
        mesh: the garment's mesh; gives the silhouette and the layer of each particle.
        lines: directed fold lines [px], in order.
        layer_thickness: height of one layer of cloth [m].
    """
    camera = flat.camera
    points = camera.to_pixels(flat.positions[:, :2])
    floor = float(flat.positions[:, 2].min())
    facets = _flat_facets(points, mesh)
    facet_of = mesh.layer.astype(int)
    for line in lines:
        facets, facet_of, points = _folded(facets, facet_of, points, line)
    layer = np.array([facet.layer for facet in facets])[facet_of]
    heights = floor + layer_thickness * layer
    positions = camera.to_world(points)
    positions[:, 2] = heights
    return IdealFold(positions, layer, _silhouette(facets, camera, floor, layer_thickness), _covered_area(facets))


def fidelity(
    final_mask: NDArray[np.bool_],
    final: SimState,
    flat: SimState,
    mesh: Mesh,
    lines: Sequence[FoldLine],
    reference: Reference,
    layer_thickness: float = LAYER_THICKNESS,
) -> Fidelity:
    """Compare a result with the ideal fold of the garment it started from.

    Args:
        final_mask: the cloth in the last picture, bool, shape (H, W).
        final: the state after the last fold.
        flat: the state before the first fold.
        mesh: the garment's mesh.
        lines: the ideal fold lines [px].
        reference: where the lines come from.
        layer_thickness: height of one layer of cloth [m].
    """
    ideal = fold_ideally(flat, mesh, lines, layer_thickness)
    travel = np.linalg.norm(ideal.positions[:, :2] - flat.positions[:, :2], axis=1)
    moved = travel > MOVED
    error = np.linalg.norm(final.positions[moved, :2] - ideal.positions[moved, :2], axis=1)
    mean_mm = 1000.0 * float(error.mean()) if moved.any() else math.nan
    return Fidelity(iou(final_mask, ideal.mask), mean_mm, int(moved.sum()), reference)


def _flat_facets(points: Floats, mesh: Mesh) -> list[_Facet]:
    """One facet per panel."""
    import shapely

    outline = shapely.make_valid(shapely.Polygon(points[mesh.boundary]))
    return [_Facet(outline, layer) for layer in range(mesh.layers)]


def _folded(
    facets: list[_Facet], facet_of: NDArray[np.int64], points: Floats, line: FoldLine
) -> tuple[list[_Facet], NDArray[np.int64], Floats]:
    """One fold: facets are cut by the line, and what is left of it turns over and comes to lie on the rest."""
    lifted_points = line.lifts(points)
    moved_points = points.copy()
    moved_points[lifted_points] = line.mirror(points[lifted_points])
    result: list[_Facet] = []
    stays, goes = {}, {}
    half_plane = _lifted_half_plane(line)
    for number, facet in enumerate(facets):
        rest = facet.polygon.difference(half_plane)
        stays[number] = len(result)
        result.append(replace(facet, polygon=rest))
    # The highest layer of the lifted stack comes down first.
    for number in sorted(range(len(facets)), key=lambda number: -facets[number].layer):
        turned = _mirrored(facets[number].polygon.intersection(half_plane), line)
        goes[number] = len(result)
        result.append(_Facet(turned, _layer_on(result, turned, facets[number].layer)))
    new_facet_of = np.array(
        [goes[int(facet)] if up else stays[int(facet)] for facet, up in zip(facet_of, lifted_points, strict=True)]
    )
    return result, new_facet_of, moved_points


def _layer_on(below: list[_Facet], turned: shapely.Geometry, otherwise: int) -> int:
    """The lowest layer above everything that the turned facet lies on; ``otherwise`` is for an empty facet."""
    if turned.is_empty:
        return otherwise
    under = [facet.layer for facet in below if facet.polygon.intersection(turned).area > TOUCHING]
    return max(under) + 1 if under else 0


def _lifted_half_plane(line: FoldLine) -> shapely.Geometry:
    """A polygon that covers all that is left of the line in any image."""
    import shapely

    start, end = np.asarray(line.start), np.asarray(line.end)
    along = (end - start) / line.length
    left = np.array([along[1], -along[0]])
    reach = 1e5
    back, front = start - reach * along, start + reach * along
    return shapely.Polygon([back, front, front + reach * left, back + reach * left])


def _mirrored(polygon: shapely.Geometry, line: FoldLine) -> shapely.Geometry:
    import shapely

    return shapely.transform(polygon, lambda points: mirror(points, line.start, line.end))


def _covered_area(facets: list[_Facet]) -> float:
    import shapely

    return float(shapely.union_all([facet.polygon for facet in facets]).area)


def _silhouette(facets: list[_Facet], camera: Camera, floor: float, layer_thickness: float) -> NDArray[np.bool_]:
    """All facets at the height of their layer, as the camera sees them, shape (H, W)."""
    mask = np.zeros((camera.height, camera.width), bool)
    for facet in facets:
        for ring in _rings(facet.polygon):
            world = camera.to_world(ring)
            world[:, 2] = floor + layer_thickness * facet.layer
            mask |= fill_polygon(camera.to_pixels(world), camera.height, camera.width)
    return mask


def _rings(geometry: Any) -> list[Floats]:
    """Outer rings of all polygons in a geometry [px], each of shape (K, 2)."""
    import shapely

    parts = [part for part in shapely.get_parts(geometry) if part.geom_type == "Polygon"]
    return [shapely.get_coordinates(part.exterior)[:-1] for part in parts]
