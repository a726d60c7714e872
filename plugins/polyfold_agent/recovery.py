"""Did a fold take effect? The picture after it is compared with the one before it, folded along the line.

Nothing here knows the garment: what is expected comes from the depth image before the fold, mirrored across the line,
so any grounding will do. The paper's method has no recovery; thresholds were set on the benchmark's tasks with seeds
2000 and 2001, where each arm in turn was made to miss.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine, contour_of, iou, mirror, rotate, turn_onto
from polyfold.types import Action, Observation

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

PICK_RADIUS, PLACE_RADIUS = 8.0, 14.0
"""Neighbourhood of a pick in which cloth is looked for, and of a place in which the flap's height is measured [px]."""

COVERED = 0.4
"""Share of a pick's neighbourhood that is still cloth where the arm took nothing."""

UNEVEN = ((1.0, 0.45), (0.35, 0.7), (0.0, 1.0))
"""How much more of the flap came down at one place than at the other, and what share of the proof is enough then."""

LANDED = 0.5
"""Share of the flap's height at a place from which the flap did come down there."""

SPECK = 5
"""Unexpected cloth narrower than this [px] is the outline's uncertainty."""

DISPLACED_FIT, DISPLACED_GAIN = 0.9, 0.05
"""A displacement is believed if it explains the picture this well (IoU), and better than none by this."""

LARGEST_TURN, TURN_STEP = 15.0, 2.5
"""Turns of a displaced garment that are tried [deg]."""

COARSE = 4
"""Displacements are searched on pictures this many times smaller."""

FRAGMENT, SLID, ALIKE = 45, 60, 3.0
"""The outline around a corner is compared as far as this to either side; how far along it a corner may have been
mistaken; the distance (root mean square) up to which two pieces of outline are the same piece [points, about px]."""

ALONG = 0.5
"""Where the second arm takes hold, as a share of the edge that still lies left of the line."""

DANGLING = 0.4
"""Share of the edge between two picks that must still lie left of the line for a second arm to help: where little is
left, it would hold the cloth below as well."""


@dataclass(frozen=True)
class Motion:
    """A rigid motion in the image: a turn about ``centre`` [rad, x towards y], then a shift [px]."""

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)

    def points(self, points: ArrayLike) -> Floats:
        """Points [px], shape (..., 2), moved."""
        return rotate(points, self.angle, self.centre) + np.asarray(self.shift)

    def line(self, line: FoldLine) -> FoldLine:
        """A fold line, moved."""
        return FoldLine.between(*self.points([line.start, line.end]))

    def matrix(self) -> Floats:
        """As OpenCV's affine map, shape (2, 3)."""
        origin = self.points([0.0, 0.0])
        return np.column_stack([self.points([1.0, 0.0]) - origin, self.points([0.0, 1.0]) - origin, origin])


@dataclass(frozen=True, eq=False)
class Attempt:
    """A fold, and the picture it was decided on.

    Attributes:
        observation, mask: the picture before the fold and the cloth in it, bool, shape (H, W).
        line: the fold line [px].
        action: the picks and places.
    """

    observation: Observation
    mask: Mask
    line: FoldLine
    action: Action

    @property
    def depth(self) -> float:
        """How far the flap reaches from the line [px]."""
        return _reach(self.mask, self.line)


@dataclass(frozen=True, eq=False)
class Finding:
    """What went wrong with a fold.

    Attributes:
        kind: ``missed`` when arms took nothing, ``astray`` when a part of the flap lies where it should not, ``left``
            when much of the flap is still on its side of the line.
        action: how to set it right; None where the whole fold should be chosen anew.
    """

    kind: Literal["missed", "astray", "left"]
    action: Action | None = None


@dataclass(frozen=True, eq=False)
class _Expected:
    """The picture that a fold should lead to.

    Attributes:
        cloth, flap: where cloth should be, and where the flap should have landed, bool, shape (H, W).
        base, height: height without and with the flap [m], shape (H, W).
    """

    cloth: Mask
    flap: Mask
    base: NDArray[np.float32]
    height: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Edge:
    """Part of a contour: which way along the contour it runs (1 or -1), and its points [px], shape (N, 2)."""

    step: int
    points: Floats

    @property
    def length(self) -> float:
        """From end to end [px]."""
        return float(_lengths(self.points)[-1])


def inspect(
    attempt: Attempt, observation: Observation, mask: Mask, remaining: float, astray: float
) -> tuple[Finding | None, Motion]:
    """Compare what a fold led to with what it should have.

    Args:
        attempt: the fold.
        observation, mask: the picture after it, and the cloth in it.
        remaining: share of the flap's depth that, still left of the line, means a failed fold.
        astray: share of the flap's depth by which cloth beyond the expected outline means a failed fold.

    Returns:
        What went wrong, or None; and how the garment was displaced since the picture before.
    """
    motion = _displacement(attempt, mask)
    moved = _moved(attempt, motion)
    covered = [_covered(mask, moved.mask, pick) for pick in moved.action.picks]
    missed = np.array(covered) > COVERED
    if missed.all():
        return Finding("missed"), motion
    if missed.any():
        return Finding("missed", Action(moved.action.picks[missed], moved.action.places[missed])), motion
    return _misplaced(moved, observation, mask, remaining, astray), motion


def _misplaced(
    attempt: Attempt, observation: Observation, mask: Mask, remaining: float, astray: float
) -> Finding | None:
    """What is wrong though every arm took its cloth away, or None."""
    left = _reach(mask, attempt.line) / attempt.depth
    if attempt.action.arms == 2:
        expected = _expected(attempt)
        tip, beyond = _tip(mask, expected)
        heights = _heights(observation, mask)
        shares = np.maximum([_landed(heights, expected, place) for place in attempt.action.places], 0.0)
        enough = next(share for difference, share in UNEVEN if np.ptp(shares) >= difference)
        overhangs = left > enough * remaining and beyond > enough * astray * attempt.depth
        if overhangs and shares.min() < LANDED:
            return Finding("astray", _brought_over(attempt, mask, int(np.argmin(shares)), tip))
    return Finding("left") if left > remaining else None


def _brought_over(attempt: Attempt, mask: Mask, arm: int, corner: Floats) -> Action:
    """The fold that brings over what one of two arms left behind and the other one pulled away.

    One arm alone would drag the edge along and bunch the flap. So that arm takes the cloth that it should have taken,
    where it lies now, and the other one takes the edge halfway to the line. As folding keeps lengths along the edge,
    both are known to belong to the original flap's mirror image.

    Args:
        attempt: the fold, moved with the garment.
        mask: the cloth now.
        arm: which arm took nothing.
        corner: roughly where its cloth lies now [px], shape (2,).
    """
    pick, place = attempt.action.picks[arm], attempt.action.places[arm]
    before, now = contour_of(attempt.mask), contour_of(mask)
    distance, motion = _same_piece(before, now, pick, corner)
    if distance > ALIKE:
        return Action(corner[None], place[None])
    first = _inside(mask, motion.points(pick), 1.0)
    edge = _between(before, pick, attempt.action.picks[1 - arm], attempt.line)
    lengths, loose = _left_behind(_from(now, first, edge.step), attempt.line)
    if lengths[-1] < DANGLING * edge.length:
        return Action(corner[None], place[None])
    length = min(ALONG * float(lengths[-1]), edge.length)
    second, origin = _inside(mask, _at(loose, length)), _inside(attempt.mask, _at(edge.points, length))
    target = mirror(origin, attempt.line.start, attempt.line.end)
    return Action(np.array([first, second]), np.array([place, target]))


def _same_piece(before: Floats, now: Floats, pick: Floats, corner: Floats) -> tuple[float, Motion]:
    """How the outline around a pick was moved to where a corner is now, and how far they still differ [px]."""
    span = np.arange(-FRAGMENT, FRAGMENT + 1)
    found = now[(_nearest(now, corner) + span) % len(now)]
    start = _nearest(before, pick)
    pieces = (before[(start + slid + span) % len(before)] for slid in range(-SLID, SLID + 1, 2))
    return min((_carried(piece, found) for piece in pieces), key=lambda fit: fit[0])


def _carried(points: Floats, goal: Floats) -> tuple[float, Motion]:
    """The rigid motion that lays points [px], shape (N, 2), on others, and the remaining distance [px]."""
    centre, target = points.mean(axis=0), goal.mean(axis=0)
    motion = Motion(turn_onto(points, goal), tuple(float(v) for v in target - centre), tuple(float(v) for v in centre))
    return float(np.sqrt(((motion.points(points) - goal) ** 2).sum(axis=1).mean())), motion


def _between(contour: Floats, pick: Floats, other: Floats, line: FoldLine) -> _Edge:
    """The edge from one pick to the other that stays left of the line, else the shorter one."""
    edges = []
    for step in (1, -1):
        points = _from(contour, pick, step)
        points = points[: _nearest(points, other) + 1]
        crosses = bool((line.distance(points) < -SPECK).any())
        edges.append((crosses, len(points), _Edge(step, points)))
    return min(edges, key=lambda edge: edge[:2])[2]


def _left_behind(edge: Floats, line: FoldLine) -> tuple[Floats, Floats]:
    """The first part of an edge, up to the line: length so far [px], shape (N,), and points, shape (N, 2)."""
    over = np.flatnonzero(line.distance(edge) <= SPECK / 2)
    points = edge[: over[0] + 1] if len(over) else edge
    return _lengths(points), points


def _from(contour: Floats, point: Floats, step: int) -> Floats:
    """A contour begun at the pixel nearest to a point, forwards or backwards."""
    return contour[(_nearest(contour, point) + step * np.arange(len(contour))) % len(contour)]


def _nearest(contour: Floats, point: Floats) -> int:
    return int(np.argmin(((contour - point) ** 2).sum(axis=1)))


def _lengths(points: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _at(points: Floats, length: float) -> Floats:
    """The point at an arc length [px] along a polyline, shape (2,)."""
    lengths = _lengths(points)
    return np.array([np.interp(length, lengths, column) for column in points.T])


def _reach(mask: Mask, line: FoldLine) -> float:
    y, x = np.nonzero(mask)
    return float(line.distance(np.column_stack([x, y])).max())


def _heights(observation: Observation, mask: Mask) -> NDArray[np.float32]:
    """Height of the cloth above the table [m], 0 beside it."""
    return np.where(mask, np.maximum(observation.camera.elevation - observation.depth, 0.0), 0.0).astype(np.float32)


def _expected(attempt: Attempt) -> _Expected:
    import cv2

    height, width = attempt.mask.shape
    y, x = np.mgrid[:height, :width]
    lifted = attempt.line.distance(np.stack([x, y], axis=-1)) > 0
    before = _heights(attempt.observation, attempt.mask)
    across = _reflection(attempt.line)
    flap = cv2.warpAffine((lifted & attempt.mask).astype(np.uint8), across, (width, height), flags=cv2.INTER_NEAREST)
    base = np.where(lifted, np.float32(0.0), before)
    above = cv2.warpAffine(np.where(lifted, before, np.float32(0.0)), across, (width, height))
    return _Expected((attempt.mask & ~lifted) | (flap > 0), flap > 0, base, base + above)


def _reflection(line: FoldLine) -> Floats:
    """Mirroring across a line as OpenCV's affine map, shape (2, 3)."""
    origin, right, down = mirror([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], line.start, line.end)
    return np.column_stack([right - origin, down - origin, origin])


def _near(point: ArrayLike, radius: float, among: Mask) -> Mask:
    y, x = np.ogrid[: among.shape[0], : among.shape[1]]
    column, row = np.asarray(point, float)
    return ((x - column) ** 2 + (y - row) ** 2 <= radius**2) & among


def _covered(mask: Mask, before: Mask, pick: Floats) -> float:
    """Share of the cloth around a pick that is still there."""
    near = _near(pick, PICK_RADIUS, before)
    return float(mask[near].mean()) if near.any() else 0.0


def _landed(heights: NDArray[np.float32], expected: _Expected, place: Floats) -> float:
    """How much of the flap's height there is around a place: 0 where none came down, about 1 where all did."""
    near = _near(place, PLACE_RADIUS, expected.flap)
    thickness = float((expected.height - expected.base)[near].mean()) if near.any() else 0.0
    return float((heights - expected.base)[near].mean()) / thickness if thickness > 1e-4 else 1.0


def _tip(mask: Mask, expected: _Expected) -> tuple[Floats, float]:
    """The cloth farthest beyond the expected outline: a pixel a little inside it, shape (2,), and how far [px]."""
    import cv2

    surplus = cv2.morphologyEx((mask & ~expected.cloth).astype(np.uint8), cv2.MORPH_OPEN, np.ones((SPECK, SPECK)))
    beyond = cv2.distanceTransform((~expected.cloth).astype(np.uint8), cv2.DIST_L2, 5) * surplus
    row, column = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
    return _inside(mask, np.array([column, row], float)), float(beyond.max())


def _inside(mask: Mask, point: Floats, inset: float = 2.5) -> Floats:
    """The pixel at least ``inset`` deep in the cloth that is nearest to a point."""
    import cv2

    deep = cv2.distanceTransform(np.pad(mask.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    y, x = np.nonzero(deep >= min(inset, float(deep.max())))
    nearest = int(np.argmin((x - point[0]) ** 2 + (y - point[1]) ** 2))
    return np.array([x[nearest], y[nearest]], float)


def _moved(attempt: Attempt, motion: Motion) -> Attempt:
    """An attempt as if the garment had lain elsewhere."""
    import cv2

    if motion == Motion():
        return attempt
    height, width = attempt.mask.shape
    seen, elevation = attempt.observation, attempt.observation.camera.elevation
    mask = cv2.warpAffine(attempt.mask.astype(np.uint8), motion.matrix(), (width, height), flags=cv2.INTER_NEAREST)
    depth = cv2.warpAffine(seen.depth, motion.matrix(), (width, height), borderValue=elevation)
    limit = np.array([width - 1.0, height - 1.0])
    picks, places = (np.clip(motion.points(p), 0.0, limit) for p in (attempt.action.picks, attempt.action.places))
    observation = Observation(seen.rgb, depth, seen.camera)
    return Attempt(observation, mask > 0, motion.line(attempt.line), Action(picks, places))


def _displacement(attempt: Attempt, mask: Mask) -> Motion:
    """How the whole garment was moved, whether or not the fold took effect; no motion where that explains little."""
    outlines = (_expected(attempt).cloth, attempt.mask)
    still = max(iou(outline, mask) for outline in outlines)
    if still >= DISPLACED_FIT:
        return Motion()
    fit, motion = max((_registered(outline, mask) for outline in outlines), key=lambda found: found[0])
    return motion if fit >= max(DISPLACED_FIT, still + DISPLACED_GAIN) else Motion()


def _registered(outline: Mask, mask: Mask) -> tuple[float, Motion]:
    """The motion that carries one silhouette onto another best, and their IoU then."""
    import cv2

    centre, goal = (np.argwhere(m)[:, ::-1].mean(axis=0) for m in (outline, mask))
    size = (mask.shape[1] // COARSE, mask.shape[0] // COARSE)
    small = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0.5
    shrink = np.diag([1.0 / COARSE, 1.0 / COARSE])

    def fit(motion: Motion) -> float:
        laid = cv2.warpAffine(outline.astype(np.uint8), shrink @ motion.matrix(), size, flags=cv2.INTER_NEAREST)
        return iou(laid > 0, small)

    def motions(turns: Floats) -> list[Motion]:
        shift = tuple(float(v) for v in goal - centre)
        return [Motion(float(np.radians(turn)), shift, tuple(float(v) for v in centre)) for turn in turns]

    coarse = max(motions(np.arange(-LARGEST_TURN, LARGEST_TURN + 1e-6, TURN_STEP)), key=fit)
    turns = np.degrees(coarse.angle) + np.linspace(-TURN_STEP, TURN_STEP, 9)
    best = max(motions(turns), key=fit)
    return fit(best), best
