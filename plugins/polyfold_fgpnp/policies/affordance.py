"""Where to pick for a fold line: the lifted part of the cloth, the affordance score, and the action it ends in.

Every policy of this plugin has the same three stages: :func:`fold_region` keeps what the line lifts, a policy chooses
two contour pixels of it (with :func:`best_pair` or :func:`second_pick`), :func:`to_action` mirrors them into an action.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, span_on_mask
from polyfold.types import Action, Scene

Floats = NDArray[np.float64]

LEAST_DEPTH_PX = 4.0
"""A part that reaches less far from the line than this can't be grasped without grasping what should stay."""

NEAR_CONTOUR_PX = 25.0
"""A vertex farther than this from the contour lies on top of the cloth, not at its edge."""

SIDE_SHARE = 0.3
"""Pieces left of the line that reach less than this share as far from it as the largest one aren't picked at."""

PARTNER_SLIDE = 0.1
"""How far a second pick moves towards the first along the contour, as a share of their distance; not in the paper."""

GAP_PX = 4.0
"""Neighbours on the contour lie closer than this; a longer step leads over the fold line to another piece."""


class PickConfig(BaseModel):
    """Parameters that all policies share."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    gamma: float = Field(0.04, ge=0, description="weight of the picks' distance to the fold line against the area")
    one_arm_px: float = Field(20.0, ge=0, description="picks closer than this become one arm at their mean [px]")
    inset_px: float = Field(2.5, ge=0, description="how far inside the cloth's edge to grasp [px]")


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
    if not fold_line.length > 0:
        raise PlanError("the fold line's start and end coincide; give two distinct points")
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

    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    return mask if count <= 2 else labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))


def _without_slivers(depth: Floats) -> NDArray[np.bool_]:
    """Cloth left of the line but for pieces that reach less far from it than a share of the deepest one.

    Pieces are told apart a little away from the line, where those that touch only along it have come apart.
    """
    import cv2

    deepest = float(depth.max())
    level = float(np.clip(0.08 * deepest, LEAST_DEPTH_PX / 2, 10.0))
    count, labels = cv2.connectedComponents((depth > level).astype(np.uint8), connectivity=4)
    reach = np.zeros(count)
    np.maximum.at(reach, labels.ravel(), depth.ravel())
    kept = reach >= SIDE_SHARE * deepest
    kept[0] = False
    size = 2 * int(np.ceil(level)) + 3
    grown = cv2.dilate(kept[labels].astype(np.uint8), np.ones((size, size), np.uint8))
    return (grown > 0) & (depth > 0)


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
    along = _along(line, pixels[depth < 2.0])
    if len(along) == 0 or np.ptp(along) < 1.0:
        return line
    direction = (np.asarray(line.end) - line.start) / line.length
    return FoldLine.between(line.start + along.min() * direction, line.start + along.max() * direction)


def _box_area(pixels: NDArray, line: FoldLine) -> float:
    return float((np.ptp(_along(line, pixels)) + 1.0) * (np.ptp(line.distance(pixels)) + 1.0))


def _along(line: FoldLine, points: ArrayLike) -> Floats:
    """Coordinate of points along the line [px], 0 at its start."""
    direction = (np.asarray(line.end) - line.start) / line.length
    return (np.asarray(points, float) - line.start) @ direction


def quadrilateral_area(start: ArrayLike, end: ArrayLike, first: ArrayLike, second: ArrayLike) -> Floats:
    """Area of the convex hull of four points [px²]; the arguments broadcast, shape (..., 2) gives shape (...,).

    In the order start, end, first, second the outline of two good corners can cross itself and enclose nothing. The
    hull's area is the largest among the areas of the three possible orders and of the four triangles.
    """
    a, b, c, d = (np.asarray(point, float) for point in (start, end, first, second))
    doubled = (
        _cross(c - a, d - b), _cross(b - a, d - c), _cross(d - a, c - b),  # outlines abcd, acbd, abdc
        _cross(b - a, c - a), _cross(b - a, d - a), _cross(c - a, d - a), _cross(c - b, d - b),
    )  # fmt: skip
    largest = np.abs(doubled[0])
    for area in doubled[1:]:
        largest = np.maximum(largest, np.abs(area))
    return largest / 2


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def affordance(region: FoldRegion, first: ArrayLike, second: ArrayLike, gamma: float) -> Floats:
    """The score S / S_max + gamma (l(first) + l(second)) / sqrt(S_max) of pairs of points [px] that broadcast."""
    line = region.fold_line
    areas = quadrilateral_area(line.start, line.end, first, second)
    distances = line.distance(first) + line.distance(second)
    return areas / region.box_area + gamma * distances / np.sqrt(region.box_area)


def best_pair(region: FoldRegion, gamma: float) -> tuple[Floats, Floats]:
    """The two contour pixels with the highest affordance score, each of shape (2,); the same one twice is possible.

    The score is ``S(start, end, p, q) / S_max + gamma (l(p) + l(q)) / sqrt(S_max)``. It is convex in p and in q, so its
    maximum over all contour pixels is attained at corners of their convex hull: comparing these few is exact.
    """
    points = _hull_corners(region)
    score = affordance(region, points[:, None], points[None, :], gamma)
    first, second = np.unravel_index(int(_first_best(score.ravel())), score.shape)
    return points[first], points[second]


def second_pick(region: FoldRegion, first: ArrayLike, gamma: float) -> Floats:
    """The contour pixels, shape (..., 2), that go best with given first picks [px], shape (..., 2).

    Each maximises ``S(start, end, first, p) / S_max + gamma l(p) / sqrt(S_max)`` over all contour pixels (paper,
    Sec. IV-D); as for :func:`best_pair`, corners of their convex hull are enough.
    """
    points = _hull_corners(region)
    return points[_first_best(affordance(region, np.asarray(first, float)[..., None, :], points, gamma))]


def coupled_pick(region: FoldRegion, first: ArrayLike, config: PickConfig, share: float = PARTNER_SLIDE) -> Floats:
    """The :func:`second_pick` of first picks, shape (..., 2), moved a little towards them (see :func:`slide`)."""
    firsts = np.asarray(first, float).reshape(-1, 2)
    partners = second_pick(region, firsts, config.gamma)
    corners, chosen = np.unique(partners, axis=0, return_inverse=True)
    for index, corner in enumerate(corners):  # Many first picks share the few corners.
        mine = chosen.ravel() == index
        partners[mine] = slide(region, corner, firsts[mine], share)
    return partners.reshape(np.shape(first))


def _hull_corners(region: FoldRegion) -> Floats:
    import cv2

    return region.points[np.sort(cv2.convexHull(region.points.astype(np.float32), returnPoints=False).ravel())]


def _first_best(scores: Floats) -> NDArray[np.int64]:
    """Indices of the highest scores along the last axis; the first one among scores that differ by rounding only."""
    return np.argmax(scores >= scores.max(axis=-1, keepdims=True) - 1e-9, axis=-1)


def slide(region: FoldRegion, pick: ArrayLike, towards: ArrayLike, share: float) -> Floats:
    """Move a contour pixel [px], shape (2,), along the contour towards others, by a share of their distance.

    ``towards`` has shape (..., 2), and so has the result.

    Cloth that is held at its outermost corners sags between them and the crease; held a little further in, both sides
    of each pick balance. It stops where the lifted part's contour ends.
    """
    pick, towards = np.asarray(pick, float), np.asarray(towards, float)
    distances = share * _length(towards - pick)
    at = int(np.argmin(((region.points - pick) ** 2).sum(1)))
    onwards = np.roll(region.points, -at, axis=0)
    backwards = np.roll(onwards[::-1], 1, axis=0)
    one, other = (_walk(path, distances) for path in (onwards, backwards))
    return np.where((_length(one - towards) <= _length(other - towards))[..., None], one, other)


def _walk(path: Floats, distances: Floats) -> Floats:
    """The points that far along a polyline [px], or the last one before a gap; distances of shape (...)."""
    steps = _length(np.diff(path, axis=0))
    gaps = np.flatnonzero(steps > GAP_PX)
    last = int(gaps[0]) if len(gaps) else len(steps)
    return path[np.minimum(np.searchsorted(np.cumsum(steps), distances + 1e-9, side="right"), last)]


def _length(vectors: Floats) -> Floats:
    return np.hypot(vectors[..., 0], vectors[..., 1])


def to_action(region: FoldRegion, first: ArrayLike, second: ArrayLike, config: PickConfig) -> Action:
    """Turn two contour pixels [px], shape (2,), into an action: picks a little inside the cloth, places mirrored.

    Two picks closer than ``one_arm_px`` become one arm at their mean. Arms are ordered along the fold line. A place
    outside the image is pulled back on its way from the pick; two arms are pulled back by the same share, so the crease
    stays parallel to the fold line and the flap lands short of its goal instead of twisted.
    """
    line = region.fold_line
    picks = np.array([first, second], float)
    if np.hypot(*(picks[0] - picks[1])) < config.one_arm_px:
        picks = picks.mean(axis=0, keepdims=True)
    picks = np.array([_inside(pick, region.mask, config.inset_px) for pick in picks])
    picks = picks[np.argsort(_along(line, picks), kind="stable")]
    height, width = region.mask.shape
    return Action(picks, _pull_back(picks, line.mirror(picks), width, height))


def _inside(pick: Floats, mask: NDArray[np.bool_], inset: float) -> Floats:
    """The nearest pixel ``inset`` deep in the cloth; where none is within twice that, the deepest one."""
    import cv2

    reach = int(np.ceil(2 * inset)) + 1
    x, y = np.round(pick).astype(int)
    top, left = max(0, y - 2 * reach), max(0, x - 2 * reach)
    window = mask[top : y + 2 * reach + 1, left : x + 2 * reach + 1]
    padded = np.pad(window, 1).astype(np.uint8)
    depth = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    rows, columns = np.nonzero(window)
    pixels = np.column_stack([columns + left, rows + top]).astype(float)
    away = np.hypot(*(pixels - pick).T)
    near = away <= max(2 * inset, 1.0)
    if not near.any():
        return _nearest_pixel(pick, mask)
    deep = np.minimum(depth[rows, columns][near], inset)
    order = np.lexsort([away[near], -deep.round(3)])
    return pixels[near][order[0]]


def _nearest_pixel(point: Floats, mask: NDArray[np.bool_]) -> Floats:
    y, x = np.nonzero(mask)
    nearest = np.argmin((x - point[0]) ** 2 + (y - point[1]) ** 2)
    return np.array([x[nearest], y[nearest]], float)


def _pull_back(picks: Floats, places: Floats, width: int, height: int) -> Floats:
    """Places moved back towards their picks, all by the same share, until they lie inside the image."""
    limit = np.array([width - 1.0, height - 1.0])
    way = places - picks
    with np.errstate(divide="ignore", invalid="ignore"):
        to_edge = np.where(way > 0, (limit - picks) / way, np.where(way < 0, -picks / way, np.inf))
    share = min(1.0, float(to_edge.min()))
    return np.clip(picks + share * way, 0.0, limit)


def nearest_point(points: Floats, to: ArrayLike) -> Floats:
    """The one among points, shape (N, 2), that is nearest to a point of shape (2,)."""
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
        raise PlanError("no visible polygon vertex lies on the contour left of the fold line; use the policy caso")
    return np.array(lifted)
