"""Masks and outlines of what is seen: numpy arrays in, numpy arrays out."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry._plane import Points, resample


def iou(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    """Intersection over union of two masks, bool, shape (H, W); 1.0 when both are empty."""
    union = np.logical_or(a, b).sum()
    return 1.0 if union == 0 else float(np.logical_and(a, b).sum() / union)


def contour_of(mask: NDArray[np.bool_]) -> Points:
    """Outer boundary [px], shape (N, 2), of the largest blob of a mask, bool, shape (H, W).

    It has about one point per pixel of length. It runs along the outer edges of the border pixels (OpenCV's own contour
    runs through their centres, half a pixel inside), with the staircase of slanted edges smoothed away so that points
    are evenly spaced at any angle.

    Raises:
        ValueError: if the mask is empty.
    """
    import cv2

    mask = np.asarray(mask, bool)
    # Pixels at odd places, the cracks between them at even ones: growing by one place lays the border on the cracks.
    cracks = np.zeros((2 * mask.shape[0] + 1, 2 * mask.shape[1] + 1), np.uint8)
    cracks[1::2, 1::2] = mask
    grown = cv2.dilate(cracks, np.ones((3, 3), np.uint8))
    found, _ = cv2.findContours(grown, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if not found:
        raise ValueError("the mask is empty; no cloth is visible")
    chain = (max(found, key=cv2.contourArea)[:, 0, :].astype(float) - 1.0) / 2.0
    smooth = sum((np.roll(chain, shift, axis=0) for shift in range(-2, 3)), np.zeros_like(chain)) / 5.0
    return resample(smooth, max(8, len(smooth) // 2))


def fill_polygon(polygon: ArrayLike, height: int, width: int) -> NDArray[np.bool_]:
    """Mask of the pixels whose centres lie inside a closed polygon, by the even-odd rule.

    Exact where OpenCV's filling also takes every pixel that the edge touches, which would cost 1 % of IoU.

    Args:
        polygon: corners [px], shape (N, 2); it may cross itself.
        height: of the mask [px].
        width: of the mask [px].

    Returns:
        The mask, bool, shape (height, width).
    """
    start = np.asarray(polygon, float)
    end = np.roll(start, -1, axis=0)
    swap = start[:, 1] > end[:, 1]
    low, high = np.where(swap[:, None], end, start), np.where(swap[:, None], start, end)
    first = np.clip(np.ceil(low[:, 1]), 0, height).astype(int)
    last = np.clip(np.ceil(high[:, 1]), 0, height).astype(int)
    count = last - first
    edge = np.repeat(np.arange(len(start)), count)
    row = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    share = (row - low[edge, 1]) / (high[edge, 1] - low[edge, 1])
    crossing = low[edge, 0] + share * (high[edge, 0] - low[edge, 0])
    column = np.clip(np.ceil(crossing), 0, width).astype(int)
    toggles = np.zeros((height, width + 1), np.int32)
    np.add.at(toggles, (row, column), 1)
    return (np.cumsum(toggles, axis=1)[:, :width] % 2).astype(bool)


def span_on_mask(
    mask: NDArray[np.bool_], start: ArrayLike, end: ArrayLike, step: float = 0.5
) -> tuple[Points, Points] | None:
    """Where the infinite line through ``start`` and ``end`` first enters and last leaves a mask.

    Args:
        mask: bool, shape (H, W).
        start: a point on the line [px], shape (2,).
        end: another one, ahead of it [px], shape (2,).
        step: distance between the places that are looked at [px].

    Returns:
        Where it enters and where it leaves [px], each of shape (2,); None when the line misses the mask.
    """
    start, end = np.asarray(start, float), np.asarray(end, float)
    direction = (end - start) / np.hypot(*(end - start))
    height, width = mask.shape
    reach = float(np.hypot(height, width)) + float(np.hypot(*start))
    along = start + np.arange(-reach, reach, step)[:, None] * direction
    x, y = np.round(along).astype(int).T
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    hit = np.zeros(len(along), bool)
    hit[inside] = mask[y[inside], x[inside]]
    if not hit.any():
        return None
    first, last = np.flatnonzero(hit)[[0, -1]]
    return along[first], along[last]
