"""Which points polygons cover, how far they overlap, and the silhouette of several polygons."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.geometry._areas import covered

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

Floats = NDArray[np.float64]


def inside_depth(point: ArrayLike, polygon: ArrayLike) -> float:
    """How deep a point, shape (2,), lies inside a polygon, shape (N, 2) [px]; negative outside."""
    point, a = np.asarray(point, float), np.asarray(polygon, float)
    b = np.roll(a, -1, axis=0)
    edge, offset = b - a, point - a
    share = np.clip((offset * edge).sum(1) / np.maximum((edge * edge).sum(1), 1e-12), 0.0, 1.0)
    distance = float(np.sqrt((((offset - share[:, None] * edge) ** 2).sum(1)).min()))
    straddles = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    height = np.where(edge[:, 1] == 0, 1.0, edge[:, 1])
    crossing = a[:, 0] + (point[1] - a[:, 1]) / height * edge[:, 0]
    return distance if (straddles & (crossing > point[0])).sum() % 2 else -distance


def nearest_point(point: ArrayLike, polygon: ArrayLike) -> Floats:
    """The point of a filled polygon, shape (N, 2), nearest to a point, shape (2,) [px]."""
    point, a = np.asarray(point, float), np.asarray(polygon, float)
    if inside_depth(point, a) >= 0.0:
        return point
    edge = np.roll(a, -1, axis=0) - a
    share = np.clip(((point - a) * edge).sum(1) / np.maximum((edge * edge).sum(1), 1e-12), 0.0, 1.0)
    candidates = a + share[:, None] * edge
    return candidates[np.hypot(*(candidates - point).T).argmin()]


def shapes(polygons: Iterable[Floats]) -> list[BaseGeometry]:
    """Polygons [px], each of shape (N, 2), as valid shapes: a piece may touch itself where a fold line met a corner."""
    return [covered(polygon) for polygon in polygons]


def overlap_area(a: Iterable[BaseGeometry], b: Iterable[BaseGeometry]) -> float:
    """Area [px²] that two sets of shapes share; the shapes of one set don't overlap each other."""
    b = list(b)
    return float(sum(one.intersection(other).area for one in a for other in b))


def covered_area(covering: Iterable[BaseGeometry]) -> float:
    """Area [px²] of the union of shapes."""
    import shapely

    return float(shapely.union_all(list(covering)).area)


def silhouette(polygons: Iterable[Floats]) -> Floats:
    """Largest outer ring [px] of the union of polygons, shape (N, 2), without repetition of its first point."""
    import shapely

    # Snapping to a fine grid keeps nearly coincident edges of stacked layers from confusing the overlay.
    united = shapely.union_all(shapes(polygons), grid_size=1e-3)
    parts = [part for part in shapely.get_parts(united) if isinstance(part, shapely.Polygon)]
    if not parts or max(part.area for part in parts) <= 0:
        raise GarmentError("the polygon model has no area; its vertices coincide or lie on one line")
    largest = max(parts, key=lambda part: part.area)
    return np.asarray(largest.exterior.coords)[:-1]


def solid_parts(polygon: Floats) -> list[Floats]:
    """Outer rings of the simple polygons that a closed line encloses [px], each of shape (K, 2).

    A simple polygon comes back as it is. One that crosses itself, such as the outline of trousers whose legs overlap,
    comes back as what it covers, in parts where it is pinched.
    """
    import shapely

    outline = shapely.Polygon(polygon)
    if outline.is_valid:
        return [polygon]
    found = shapely.get_parts(shapely.get_parts(covered(outline.exterior.coords)))
    return [shapely.get_coordinates(part.exterior)[:-1] for part in found if isinstance(part, shapely.Polygon)]
