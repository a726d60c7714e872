"""A white sheet of paper in a photograph, by its four edges and the ratio of its sides."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError
from polyfold.geometry._homography import homography

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

WORKING_SIZE = 1000
"""Longer side of the picture that sheets are sought in [px]."""

SMALLEST = 0.002
"""Share of the picture that a sheet must cover: else its corners say too little."""

PALE = 60
"""Paper's colour channels differ by no more than this [RGB units]."""

FOCAL_LENGTHS = np.geomspace(0.6, 4.0, 40)
"""Those that cameras have, in longer sides of the picture."""

UNUSUAL = 0.02
"""What a focal length counts that is e times as long or as short as the picture: it tells upright sheets from lying."""

AS_IT_SHOULD = 0.06
"""How far the ratio of sides and the right angles may be off, under the best focal length."""

PROFILES, REACH = 60, 6.0
"""Places along an edge where it is sought, and how far to both sides [px]."""


def find_paper(rgb: Picture, sides: tuple[float, float], name: str) -> tuple[Floats, tuple[float, float]]:
    """Find a sheet.

    Args:
        rgb: the photograph, uint8, shape (H, W, 3).
        sides: longer and shorter side [m].
        name: of the sheet, for messages.

    Returns:
        Its corners [px], shape (4, 2), clockwise as seen, and how long it is from the first to the second one and from
        the second to the third [m].

    Raises:
        GarmentError: if no white quadrilateral can be such a sheet.
    """
    import cv2

    height, width = rgb.shape[:2]
    scale = min(1.0, WORKING_SIZE / max(height, width))
    size = (round(width * scale), round(height * scale))
    small = np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8) if scale < 1.0 else rgb
    best: tuple[float, Floats, tuple[float, float]] | None = None
    for corners in _quadrilaterals(small):
        whiteness = _whiteness(small, corners)
        if whiteness is None:
            continue
        centred = corners - [(size[0] - 1) / 2, (size[1] - 1) / 2]
        for across, down in (sides, sides[::-1]):
            off = _distortion(centred, across / down, max(size))
            worth = whiteness - 10 * off
            if off < AS_IT_SHOULD and (best is None or worth > best[0]):
                best = worth, corners, (across, down)
    if best is None:
        raise GarmentError(
            f"no sheet of {name} is to be seen; lay a white one flat beside the cloth, wholly in the picture, where "
            "the table is darker than it"
        )
    grey = np.asarray(cv2.GaussianBlur(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), (0, 0), 1.0), np.uint8)
    return _refined(grey, (best[1] + 0.5) / scale - 0.5, 1.0 / scale), best[2]


def _quadrilaterals(small: Picture) -> Iterator[Floats]:
    """Convex outlines of four corners, clockwise as seen, at any of many thresholds of brightness."""
    import cv2

    # The darkest channel: paper is bright in all three, a coloured shirt is not.
    darkest = cv2.GaussianBlur(small.min(axis=2), (0, 0), 1.0)
    levels = np.unique(np.linspace(60, 252, 60).astype(int))
    for level in levels:
        bright = cv2.morphologyEx((darkest > level).astype(np.uint8), cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
        outlines, _ = cv2.findContours(bright, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
        for outline in outlines:
            area = cv2.contourArea(outline)
            if not SMALLEST * darkest.size < area < 0.5 * darkest.size:
                continue
            corners = cv2.approxPolyDP(outline, 0.03 * cv2.arcLength(outline, True), True)[:, 0].astype(float)
            if len(corners) != 4 or not cv2.isContourConvex(corners.astype(np.int32)):
                continue
            if area < 0.9 * cv2.contourArea(corners.astype(np.float32)) or _at_border(corners, darkest.shape):
                continue
            yield _clockwise(corners)


def _at_border(corners: Floats, shape: tuple[int, ...]) -> bool:
    return bool((corners < 2).any() or (corners > np.array(shape[1::-1]) - 3).any())


def _clockwise(corners: Floats) -> Floats:
    """As seen, from the corner nearest to the picture's top left on."""
    middle = corners - corners.mean(axis=0)
    ring = corners[np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))]
    return np.roll(ring, -int(np.argmin(ring.sum(axis=1))), axis=0)


def _whiteness(small: Picture, corners: Floats) -> float | None:
    """How bright and even what a quadrilateral encloses is, 0 to 1; None if it is no paper."""
    import cv2

    inside = np.zeros(small.shape[:2], np.uint8)
    shrunk = corners.mean(axis=0) + 0.9 * (corners - corners.mean(axis=0))
    cv2.fillConvexPoly(inside, np.round(shrunk).astype(np.int32), 1)
    pixels = small[inside.astype(bool)].astype(float)
    colour = np.median(pixels, axis=0)
    if np.ptp(colour) > PALE or colour.min() < 80:
        return None
    even = 1.0 - min(1.0, float(pixels.std(axis=0).mean()) / 40.0)
    return float(colour.min() / 255.0 * even)


def _distortion(corners: Floats, ratio: float, longer: float) -> float:
    """How far a quadrilateral is from a rectangle of a ratio of sides, under the focal length that suits it best.

    Args:
        corners: about the picture's centre [px], shape (4, 2).
        ratio: of the side from the first to the second corner to the next one.
        longer: the picture's longer side [px].
    """
    matrix = homography([[0, 0], [ratio, 0], [ratio, 1], [0, 1]], corners)
    focal = FOCAL_LENGTHS[:, None] * longer
    across, down = (
        np.column_stack([matrix[0, k] / focal, matrix[1, k] / focal, np.full(len(focal), matrix[2, k])]) for k in (0, 1)
    )
    lengths = np.linalg.norm(across, axis=1), np.linalg.norm(down, axis=1)
    unequal = np.abs(np.log(lengths[0] / lengths[1]))
    askew = np.abs((across * down).sum(axis=1)) / (lengths[0] * lengths[1])
    unusual = UNUSUAL * np.abs(np.log(FOCAL_LENGTHS))
    return float((np.hypot(unequal, askew) + unusual).min())


def _refined(grey: NDArray[np.uint8], corners: Floats, reach: float) -> Floats:
    """Corners where lines through the edges meet, each fitted to the steepest place of profiles across it."""
    ends = [*pairwise(corners), (corners[-1], corners[0])]
    lines = [_edge_line(grey, start, end, REACH * max(1.0, reach)) for start, end in ends]
    found = [np.cross(lines[index - 1], lines[index]) for index in range(4)]
    meeting = np.array([point[:2] / point[2] for point in found])
    moved = np.linalg.norm(meeting - corners, axis=1)
    return np.where((moved < 3 * REACH * max(1.0, reach))[:, None], meeting, corners)


def _edge_line(grey: NDArray[np.uint8], start: Floats, end: Floats, reach: float) -> Floats:
    """The line (a, b, c) with a x + b y + c = 0 along an edge between two corners."""
    from scipy import ndimage

    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    at = start + np.linspace(0.08, 0.92, PROFILES)[:, None] * (end - start)
    offsets = np.arange(-reach, reach + 0.25, 0.5)
    x, y = np.moveaxis(at[:, None] + offsets[None, :, None] * across, -1, 0)
    profiles = np.asarray(ndimage.map_coordinates(grey.astype(float), [y, x], order=1, mode="nearest"))
    steps = np.abs(np.diff(profiles, axis=1))
    steps[steps < 0.5 * steps.max(axis=1, keepdims=True)] = 0.0
    middles = (offsets[1:] + offsets[:-1]) / 2
    total = steps.sum(axis=1)
    edge = at + ((steps @ middles) / np.where(total > 0, total, 1.0))[:, None] * across
    return _robust_line(edge[total > 0] if (total > 0).sum() > 4 else at)


def _robust_line(points: Floats) -> Floats:
    """The line through most of the points, those that are far off left out."""
    middle, normal = _line(points)
    for _ in range(4):
        off = np.abs((points - middle) @ normal)
        middle, normal = _line(points[off <= max(0.3, 2.5 * float(np.median(off)))])
    return np.array([normal[0], normal[1], -normal @ middle])


def _line(points: Floats) -> tuple[Floats, Floats]:
    """A point on the line through points, shape (N, 2), and its normal, each of shape (2,)."""
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle)[2][-1]
