"""The cloth in a colour picture with a plain background: one way for the simulated camera and for photographs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError

Mask = NDArray[np.bool_]

INLIER = 60.0
"""Border pixels further than this [RGB units] from the border's median colour are no background."""

NEAR_COLOURS = 200.0
"""Beyond this distance [RGB units] everything counts as equally unlike the background when a threshold is sought."""


DOUBTFUL = 0.3
"""Largest share, relative to the cloth, of pixels that are neither clearly cloth nor clearly background."""

UNDIVIDED = 0.6
"""Smallest share of all cloth-like pixels that must belong to the largest blob."""

TOO_ALIKE = (
    "no cloth stands out clearly from the background: their colours are too alike in places, or there are several "
    "things; use a plain background of another colour, or give a mask"
)


def find_cloth(
    rgb: NDArray[np.uint8], threshold: float | None = None, smallest: float = 0.002, largest_hole: float = 0.0005
) -> Mask:
    """Mask of the largest thing that differs from the background, bool, shape (H, W).

    The background's colour is estimated from the image's border and may change slowly across the image.

    Args:
        rgb: the picture, uint8, shape (H, W, 3).
        threshold: colour distance [RGB units, 0..441] from the background that makes cloth; None finds one (Otsu).
        smallest: share of the image that the cloth must cover.
        largest_hole: holes of up to this share of the image are filled.

    Raises:
        GarmentError: if nothing stands out clearly, or what does reaches all four borders.
    """
    distance, noise = colour_distance(rgb)
    limit = _separating_threshold(distance, noise) if threshold is None else threshold
    cleaned = _without_specks(distance > limit)
    mask, area = _largest_blob(cleaned)
    if area < smallest * mask.size:
        raise GarmentError(
            f"no cloth stands out from the background (largest blob: {area} pixels); "
            "use a plain background of another colour, or give a mask"
        )
    if threshold is None:
        _check_clear(distance, limit, area, int(cleaned.sum()))
    if all(edge.mean() > 0.02 for edge in (mask[0], mask[-1], mask[:, 0], mask[:, -1])):
        raise GarmentError(
            "what stands out touches all four borders of the picture; show the whole cloth with background around it"
        )
    return _without_small_holes(mask, largest_hole * mask.size)


def colour_distance(rgb: NDArray[np.uint8]) -> tuple[NDArray[np.float32], float]:
    """Distance of each pixel from the background's colour, shape (H, W), and its typical size on the background."""
    rgb = np.asarray(rgb)
    if rgb.ndim != 3 or rgb.shape[2] != 3 or min(rgb.shape[:2]) < 16:
        raise GarmentError(f"a colour picture of shape (H, W, 3) is needed, got {rgb.shape}; convert it to RGB")
    height, width = rgb.shape[:2]
    strip = max(2, min(height, width) // 40)
    rows, columns = np.mgrid[0:height, 0:width]
    on_border = np.minimum(np.minimum(rows, height - 1 - rows), np.minimum(columns, width - 1 - columns)) < strip
    y, x = rows[on_border] / height, columns[on_border] / width
    colours = rgb[on_border].astype(np.float64)
    plane = _background_plane(x, y, colours)
    grid = np.stack([np.ones((height, width)), columns / width, rows / height], axis=-1)
    distance = np.linalg.norm(rgb - grid @ plane, axis=-1).astype(np.float32)
    border = distance[on_border]
    near = border[border < INLIER]
    noise = float(np.median(near)) if len(near) else float(np.median(border))
    return distance, noise


def _background_plane(x: Any, y: Any, colours: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coefficients (1, x, y) of the background's colour, shape (3, 3), cloth at the border left out."""
    near = np.linalg.norm(colours - np.median(colours, axis=0), axis=1) < INLIER
    if near.sum() < 0.3 * len(colours):
        raise GarmentError("the picture's border shows no single background colour; use a plain background")
    design = np.column_stack([np.ones(near.sum()), x[near], y[near]])
    return np.asarray(np.linalg.lstsq(design, colours[near], rcond=None)[0], float)


def _separating_threshold(distance: NDArray[np.float32], noise: float) -> float:
    """Otsu's threshold on colour distances, never inside the background's own noise."""
    import cv2

    scaled = np.clip(distance * (255.0 / NEAR_COLOURS), 0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(scaled, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    threshold = max(otsu * NEAR_COLOURS / 255.0, 1.0)
    cloth, background = distance[distance > threshold], distance[distance <= threshold]
    if not len(cloth) or float(np.median(cloth)) - float(np.median(background)) < max(15.0, 4.0 * noise):
        raise GarmentError(TOO_ALIKE)
    return max(threshold, 3.0 * noise)


def _check_clear(distance: NDArray[np.float32], threshold: float, area: int, total: int) -> None:
    """Refuse a picture whose cloth is a matter of where exactly the threshold lies, or comes in several pieces."""
    doubtful = int(((distance > 0.7 * threshold) & (distance < 1.3 * threshold)).sum())
    if doubtful > DOUBTFUL * area or area < UNDIVIDED * total:
        raise GarmentError(TOO_ALIKE)


def _without_specks(mask: Mask) -> Mask:
    """Hairlines and single pixels removed; the brush grows with the picture."""
    import cv2

    size = max(3, 2 * (min(mask.shape) // 400) + 1)
    brush = cv2.getStructuringElement(cv2.MORPH_CROSS if size == 3 else cv2.MORPH_ELLIPSE, (size, size))
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, brush)
    return cv2.morphologyEx(closed, cv2.MORPH_OPEN, brush).astype(bool)


def _largest_blob(mask: Mask) -> tuple[Mask, int]:
    import cv2

    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    if count < 2:
        return np.zeros_like(mask), 0
    largest = 1 + int(np.argmax(statistics[1:, cv2.CC_STAT_AREA]))
    return labels == largest, int(statistics[largest, cv2.CC_STAT_AREA])


def _without_small_holes(mask: Mask, largest: float) -> Mask:
    import cv2

    count, labels, statistics, _ = cv2.connectedComponentsWithStats((~mask).astype(np.uint8), connectivity=4)
    small = [label for label in range(1, count) if statistics[label, cv2.CC_STAT_AREA] <= largest]
    return mask | np.isin(labels, small)
