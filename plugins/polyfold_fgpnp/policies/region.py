"""The part of the cloth that a fold line lifts, and where it may be picked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, span_on_mask
from polyfold.types import Scene

Floats = NDArray[np.float64]

LEAST_DEPTH_PX = 4.0
"""A part that reaches less far from the line than this can't be grasped without grasping what should stay."""

NEAR_CONTOUR_PX = 25.0
"""A vertex farther than this from the contour lies on top of the cloth, not at its edge."""

SIDE_SHARE = 0.3
"""Pieces left of the line that reach less than this share as far from it as the largest one aren't picked at."""


@dataclass(frozen=True, eq=False)
class FoldRegion:
    """The part of the cloth that a fold line lifts, and where it may be picked.

    Attributes:
        fold_line: the line, from where it enters the lifted part to where it leaves it.
        mask: the partial mask, cloth left of the line, bool, shape (H, W).
        points: the cloth's contour left of the line [px], shape (N, 2), in contour order.
        distances: from ``points`` to the line [px], shape (N,).
        box_area: S_max, area of the partial mask's bounding box along and across the line [px²].
    """

    fold_line: FoldLine
    mask: NDArray[np.bool_]
    points: Floats
    distances: Floats
    box_area: float


def fold_region(fold_line: FoldLine, scene: Scene) -> FoldRegion:
    """Keep the cloth left of the line, and shrink the line to where it meets that cloth.

    A line along one armhole of a shirt that widens towards its hem also cuts a sliver off the side. Such pieces, which
    reach far less from the line than the largest one, are left out: a pick there would be wasted. The bounding box is
    taken along the line and not along the image, so that the choice of picks turns with the cloth.

    Raises:
        PlanError: if the line misses the cloth, or no cloth worth grasping lies left of it.
    """
    cloth = _largest_blob(scene.mask)
    if span_on_mask(cloth, fold_line.start, fold_line.end) is None:
        raise PlanError("the fold line misses the cloth, so nothing can be folded; move the line onto the cloth")
    y, x = np.nonzero(cloth)
    depth = np.zeros(cloth.shape)
    depth[y, x] = fold_line.distance(np.column_stack([x, y]))
    if depth.max() < LEAST_DEPTH_PX:
        raise PlanError(
            "no cloth lies left of the fold line, and the left part is the one that is lifted; "
            "swap its start and end, or move it into the cloth"
        )
    mask = _without_slivers(depth)
    points, distances = _contour_of_part(scene.contour, mask, fold_line)
    y, x = np.nonzero(mask)
    pixels = np.column_stack([x, y])
    return FoldRegion(
        fold_line=_crease(fold_line, pixels, depth[mask]),
        mask=mask,
        points=points,
        distances=distances,
        box_area=_box_area(pixels, fold_line),
    )


def _largest_blob(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The piece that the contour runs around; stray pixels elsewhere would pass for a flap far from the line."""
    import cv2

    count, found, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    return mask if count <= 2 else np.asarray(found) == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))


def _without_slivers(depth: Floats) -> NDArray[np.bool_]:
    """Cloth left of the line but for pieces that reach less far from it than a share of the deepest one.

    Pieces are told apart a little away from the line, where those that touch only along it have come apart.
    """
    import cv2

    deepest = float(depth.max())
    level = float(np.clip(0.08 * deepest, LEAST_DEPTH_PX / 2, 10.0))
    count, found = cv2.connectedComponents((depth > level).astype(np.uint8), connectivity=4)
    labels = np.asarray(found, np.int32)
    reach = np.zeros(count)
    np.maximum.at(reach, labels.ravel(), depth.ravel())
    kept = reach >= SIDE_SHARE * deepest
    kept[0] = False
    size = 2 * int(np.ceil(level)) + 3
    grown = cv2.dilate(kept[labels].astype(np.uint8), np.ones((size, size), np.uint8))
    return (np.asarray(grown) > 0) & (depth > 0)


def _contour_of_part(contour: Floats, mask: NDArray[np.bool_], line: FoldLine) -> tuple[Floats, Floats]:
    """Contour pixels left of the line that belong to a partial mask, and their distances to the line."""
    contour = np.asarray(contour, float)
    distances = line.distance(contour)
    x, y = np.round(contour).astype(int).T
    height, width = mask.shape
    near = np.zeros(len(contour), bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            near |= mask[np.clip(y + dy, 0, height - 1), np.clip(x + dx, 0, width - 1)]
    kept = near & (distances > 0)
    if not kept.any():
        raise PlanError("the cloth's contour and mask disagree left of the fold line; segment the image again")
    return contour[kept], distances[kept]


def _crease(line: FoldLine, pixels: NDArray, depth: Floats) -> FoldLine:
    """The line between the first and the last pixel of the lifted part next to it; the line itself if none is."""
    along = along_line(line, pixels[depth < 2.0])
    if len(along) == 0 or np.ptp(along) < 1.0:
        return line
    direction = (np.asarray(line.end) - line.start) / line.length
    return FoldLine.between(line.start + along.min() * direction, line.start + along.max() * direction)


def _box_area(pixels: NDArray, line: FoldLine) -> float:
    return float((np.ptp(along_line(line, pixels)) + 1.0) * (np.ptp(line.distance(pixels)) + 1.0))


def along_line(line: FoldLine, points: ArrayLike) -> Floats:
    """Coordinate along a line of points [px], shape (..., 2): 0 at its start [px], shape (...)."""
    direction = (np.asarray(line.end) - line.start) / line.length
    return (np.asarray(points, float) - line.start) @ direction


def nearest_point(points: Floats, to: ArrayLike) -> Floats:
    """The one among points [px], shape (N, 2), that is nearest to a point of shape (2,)."""
    return points[np.argmin(((points - np.asarray(to, float)) ** 2).sum(1))]


def lifted_vertices(region: FoldRegion, scene: Scene) -> Floats:
    """Visible vertices left of the line and near the lifted contour [px], shape (N, 2), in the model's order.

    Raises PlanError when the scene has no polygon model, or no such vertex.
    """
    if scene.model is None:
        raise PlanError("this policy picks at polygon vertices, and the scene has no polygon; ground with polygon")
    visible = [state.point for state in scene.model.vertices().values() if state.visible]
    points = np.array(visible, float).reshape(-1, 2)
    lifted = [
        point
        for point in points[region.fold_line.lifts(points)]
        if np.hypot(*(nearest_point(region.points, point) - point)) <= NEAR_CONTOUR_PX
    ]
    if not lifted:
        raise PlanError(
            "no visible polygon vertex lies on the contour left of the fold line; use the policy affordance-pair"
        )
    return np.array(lifted)
