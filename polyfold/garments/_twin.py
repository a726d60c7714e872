"""The simulated twin of a real garment: an outline with fitted keypoints, cut out of cloth and sewn together."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.garments._garment import Garment
from polyfold.garments._outline import Outline
from polyfold.garments._panels import mesh_panels
from polyfold.garments._pattern import Pattern
from polyfold.geometry import polygon_area
from polyfold.geometry._areas import covered

Floats = NDArray[np.float64]

FINE = 0.25  # spacing of the working outline, in edge lengths
SMOOTHING = 0.6  # standard deviation of the smoothing along the outline, in edge lengths
WHISKER = 0.3  # parts thinner than twice this are cut off, in edge lengths
HIDDEN = 0.25  # how far inside the garment a slit's end lies if the slit is closed, as a share of its length
SLIT = 1.6  # width of a slit that is cut, between its two sides, in edge lengths
FAR = 0.15  # how far a keypoint may lie from the outline, as a share of the garment's size
SMALLEST, LARGEST = 0.05, 3.0  # plausible longest sides [m]


ONE_LAYER_EDGE, TWO_LAYER_EDGE = 0.010, 0.0125
"""Mesh sizes [m]: a towel is smaller than a shirt and has half the particles."""


def twin_from_outline(
    outline: ArrayLike,
    kind: str,
    keypoints: Mapping[str, ArrayLike],
    pattern: Pattern,
    size_m: float | None = None,
    edge_length: float | None = None,
    *,
    name: str | None = None,
) -> Garment:
    """Build a garment from the outline of a real one that lies flat.

    The twin lies upright; left and right stay as seen.

    Args:
        outline: the silhouette [px, y down], shape (M, 2).
        kind: registered garment kind.
        keypoints: keypoint name -> pixel, shape (2,), all of the kind's names; they are moved onto the outline.
        pattern: how the garment is sewn.
        size_m: longest side of the upright garment's bounding box [m]; by default one that is typical of the kind.
        edge_length: mesh size [m]; by default 10 mm for one layer, 12.5 mm for two.
        name: the garment's name, by default ``<kind>-twin``.

    Raises:
        GarmentError: if keypoints are missing or do not go round the outline in order, or the outline is unusable.
    """
    size = pattern.size if size_m is None else float(size_m)
    if not SMALLEST <= size <= LARGEST:
        raise GarmentError(f"a garment of {size} m is not plausible; give its longest side in metres")
    if edge_length is None:
        edge_length = ONE_LAYER_EDGE if pattern.layers == 1 else TWO_LAYER_EDGE
    flip = np.array([1.0, -1.0])
    corners = _complete(keypoints, pattern) * flip
    ring = repair_outline(np.asarray(outline, float) * flip)
    ring, corners = _upright(ring, corners, pattern, size)
    ring = _with_slits(ring, corners, pattern, edge_length)
    cut = _cut_out(ring, corners, pattern, edge_length).centred()
    mesh, vertices = mesh_panels(cut, pattern.layers, edge_length)
    return Garment(kind, name or f"{kind}-twin", None, mesh, vertices, cyclic=pattern.cyclic)


def upright_size(outline: ArrayLike, keypoints: Mapping[str, ArrayLike], pattern: Pattern) -> float:
    """The longest side of an upright garment's bounding box, in the unit of its outline; as in twin_from_outline."""
    flip = np.array([1.0, -1.0])
    ring = repair_outline(np.asarray(outline, float) * flip)
    upright, _ = _upright(ring, _complete(keypoints, pattern) * flip, pattern, 1.0)
    # A turn keeps areas, so that they tell what scaled the ring to a side of 1.
    return float(np.sqrt(abs(polygon_area(ring) / polygon_area(upright))))


def angle_of(keypoints: Mapping[str, ArrayLike], pattern: Pattern) -> float:
    """How far a garment lies turned from upright, counter-clockwise as seen [degrees], from its pixels (y down)."""
    right, up = pattern.up(
        dict(zip(pattern.corners, _complete(keypoints, pattern) * np.array([1.0, -1.0]), strict=True))
    )
    return float(np.degrees(np.arctan2(-right, up)))


def repair_outline(outline: ArrayLike) -> Floats:
    """The outline without self-intersections, clockwise seen with y up, shape (K, 2).

    Raises:
        GarmentError: if what remains is less than three quarters of what it seemed to enclose.
    """
    import shapely

    points = np.asarray(outline, float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise GarmentError("an outline needs at least three finite points, shape (M, 2); correct it")
    parts = [part for part in shapely.get_parts(shapely.get_parts(covered(points))) if part.geom_type == "Polygon"]
    largest = max(parts, key=lambda part: part.area, default=None)
    if largest is None or largest.area <= 0:
        raise GarmentError("the outline encloses nothing; draw it around the garment once")
    if largest.area < 0.75 * sum(part.area for part in parts):
        raise GarmentError("the outline crosses itself and falls apart; draw it around the garment once")
    return _clockwise(shapely.get_coordinates(largest.exterior)[:-1])


def _clockwise(ring: Floats) -> Floats:
    return ring[::-1] if polygon_area(ring) > 0 else ring


def _complete(keypoints: Mapping[str, ArrayLike], pattern: Pattern) -> Floats:
    """The keypoints in the pattern's order, shape (K, 2)."""
    missing = [name for name in pattern.corners if name not in keypoints]
    if missing:
        raise GarmentError(f"the keypoints {', '.join(missing)} are missing; name all of {', '.join(pattern.corners)}")
    corners = np.array([np.asarray(keypoints[name], float) for name in pattern.corners])
    if corners.shape[1:] != (2,) or not np.isfinite(corners).all():
        raise GarmentError("keypoints must be finite pixels (x, y); correct them")
    return corners


def _upright(ring: Floats, corners: Floats, pattern: Pattern, size: float) -> tuple[Floats, Floats]:
    """Turned so that bottom to top points up, and scaled to the size [m]."""
    places = {name: corners[index] for index, name in enumerate(pattern.corners)}
    up = pattern.up(places)
    length = float(np.hypot(*up))
    if length == 0.0:
        raise GarmentError("the top and the bottom of the garment coincide; correct the keypoints")
    x_axis, y_axis = np.array([up[1], -up[0]]) / length, up / length
    turn = np.column_stack([x_axis, y_axis])
    ring, corners = ring @ turn, corners @ turn
    scale = size / np.ptp(ring, axis=0).max()
    return ring * scale, corners * scale


def _with_slits(ring: Floats, corners: Floats, pattern: Pattern, edge_length: float) -> Floats:
    """The ring with closed slits cut open, as between trouser legs that lie side by side."""
    import shapely

    for name in pattern.slits:
        index = pattern.corners.index(name)
        end, sides = corners[index], corners[[index - 1, (index + 1) % len(corners)]]
        along = sides.mean(0) - end
        length = float(np.hypot(*along))
        garment = shapely.Polygon(ring)
        inside = garment.contains(shapely.Point(end))
        if length == 0.0 or not inside or garment.exterior.distance(shapely.Point(end)) < HIDDEN * length:
            continue
        across = np.array([-along[1], along[0]]) / length
        half = SLIT * edge_length / 2
        # Half as long again as needed, so that it leaves the garment wherever the outline runs.
        wedge = shapely.Polygon([end, end + 1.5 * (along + half * across), end + 1.5 * (along - half * across)])
        parts = shapely.get_parts(garment.difference(wedge))
        largest = max(parts, key=lambda part: part.area)
        ring = _clockwise(shapely.get_coordinates(largest.exterior)[:-1])
    return ring


def _cut_out(ring: Floats, corners: Floats, pattern: Pattern, edge_length: float) -> Outline:
    """The outline smoothed to what the mesh can show, with the keypoints on it."""
    fine = _finely(_without_whiskers(ring, edge_length), FINE * edge_length)
    if len(fine) < 4 * len(corners):
        raise GarmentError(f"the outline is too small for an edge length of {edge_length} m; use a finer edge length")
    places = _places_on(fine, corners, pattern)
    start = places[0]
    fine, places = np.roll(fine, -start, axis=0), [(place - start) % len(fine) for place in places]
    stops = [*places, len(fine)]
    closed = np.vstack([fine, fine[:1]])
    pieces = [_smoothed(closed[first : last + 1], SMOOTHING / FINE)[:-1] for first, last in pairwise(stops)]
    return Outline(np.vstack(pieces), dict(zip(pattern.corners, places, strict=True)), pattern.openings)


def _without_whiskers(ring: Floats, edge_length: float) -> Floats:
    """Spikes that no triangle fits into are cut off."""
    import shapely

    radius = WHISKER * edge_length
    opened = shapely.Polygon(ring).buffer(-radius).buffer(radius, join_style="mitre", mitre_limit=3.0)
    parts = shapely.get_parts(opened)
    if not len(parts):
        raise GarmentError(f"the outline is too small for an edge length of {edge_length} m; use a finer edge length")
    largest = max(parts, key=lambda part: part.area)
    return _clockwise(shapely.get_coordinates(largest.exterior)[:-1])


def _finely(ring: Floats, spacing: float) -> Floats:
    closed = np.vstack([ring, ring[:1]])
    position = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    at = np.linspace(0.0, position[-1], max(12, round(position[-1] / spacing)), endpoint=False)
    return np.column_stack([np.interp(at, position, closed[:, 0]), np.interp(at, position, closed[:, 1])])


def _places_on(ring: Floats, corners: Floats, pattern: Pattern) -> list[int]:
    """For each corner an index into the clockwise ring, in the pattern's order around it, as near as that allows.

    The corner that is farthest from the others goes to its nearest point; the others are placed by dynamic
    programming, which keeps two corners that lie close together from changing places.
    """
    apart = np.hypot(*(corners[:, None] - corners[None]).transpose(2, 0, 1)) + np.diag(np.full(len(corners), np.inf))
    lead = int(np.argmax(apart.min(1)))
    first = int(np.argmin(np.hypot(*(ring - corners[lead]).T)))
    turned, others = np.roll(ring, -first, axis=0), np.roll(corners, -lead, axis=0)
    order = [0, *_in_order(np.square(turned[None] - others[1:, None]).sum(-1))]
    distance = np.hypot(*(turned[order] - others).T)
    if distance.max() > FAR * np.ptp(ring, axis=0).max():
        worst = pattern.corners[(int(np.argmax(distance)) + lead) % len(corners)]
        raise GarmentError(
            f"the keypoint {worst} lies far from the outline, or the keypoints do not go round it clockwise "
            f"({', '.join(pattern.corners[:3])}, ...); check the keypoints, and that the picture is not mirrored"
        )
    places = [(place + first) % len(ring) for place in order]
    return places[-lead:] + places[:-lead] if lead else places


def _in_order(cost: Floats, gap: int = 3) -> list[int]:
    """The cheapest increasing columns, one per row, at least ``gap`` apart and away from both ends."""
    rows, columns = cost.shape
    best = np.full(cost.shape, np.inf)
    best[0, gap:] = cost[0, gap:]
    came_from = np.zeros(cost.shape, int)
    for row in range(1, rows):
        cheapest = np.minimum.accumulate(best[row - 1])
        where = np.maximum.accumulate(np.where(best[row - 1] <= cheapest, np.arange(columns), 0))
        best[row, gap:] = cheapest[:-gap] + cost[row, gap:]
        came_from[row, gap:] = where[:-gap]
    best[-1, columns - gap :] = np.inf
    chosen = [int(np.argmin(best[-1]))]
    for row in range(rows - 1, 0, -1):
        chosen.append(int(came_from[row, chosen[-1]]))
    return chosen[::-1]


def _smoothed(piece: Floats, sigma: float) -> Floats:
    """A piece of outline smoothed along itself, its ends kept; ``sigma`` in samples."""
    reach = min(int(np.ceil(3 * sigma)), len(piece) - 1)
    if reach < 1:
        return piece
    before, after = 2 * piece[0] - piece[reach:0:-1], 2 * piece[-1] - piece[-2 : -reach - 2 : -1]
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    extended = np.vstack([before, piece, after])
    columns = [np.convolve(extended[:, axis], kernel / kernel.sum(), "valid") for axis in (0, 1)]
    return np.asarray(np.column_stack(columns), float)
