"""Which points a polygon covers, and the silhouette of several polygons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError

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


def silhouette(polygons: Sequence[ArrayLike]) -> Floats:
    """Largest outer ring of the union of polygons, shape (N, 2), without repetition of its first point."""
    import shapely

    shapes = [shapely.Polygon(p) for p in polygons]
    # A piece may touch itself where a fold line met a corner.
    shapes = [shape if shape.is_valid else shapely.make_valid(shape) for shape in shapes]
    # Snapping to a fine grid keeps nearly coincident edges of stacked layers from confusing the overlay.
    united = shapely.union_all(shapes, grid_size=1e-3)
    parts = [part for part in getattr(united, "geoms", [united]) if isinstance(part, shapely.Polygon)]
    if not parts or max(part.area for part in parts) <= 0:
        raise GarmentError("the polygon model has no area; its vertices coincide or lie on one line")
    largest = max(parts, key=lambda part: part.area)
    return np.asarray(largest.exterior.coords)[:-1]
