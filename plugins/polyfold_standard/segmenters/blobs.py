"""Masks put in order: the thing itself without cables, specks and small holes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]

LARGEST_HOLE = 0.01
"""Holes of up to this share of the picture are filled: prints and spots that look like the table."""

AT_THE_BORDER = 20.0
"""How much less a blob counts if the picture's border cuts it off: things that reach in are seldom the garment."""


def disk(radius: int) -> NDArray[np.uint8]:
    """A round brush."""
    import cv2

    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1)), np.uint8)


def opened(mask: Mask, radius: int) -> Mask:
    """Without what is thinner than a disk."""
    import cv2

    return cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, disk(radius)).astype(bool)


def closed(mask: Mask, radius: int) -> Mask:
    """With gaps filled that are thinner than a disk."""
    import cv2

    margin = 2 * radius  # else the border would close every gap beside it
    wide = cv2.morphologyEx(np.pad(mask.astype(np.uint8), margin), cv2.MORPH_CLOSE, disk(radius))
    return wide[margin:-margin, margin:-margin].astype(bool)


def grown(mask: Mask, radius: int) -> Mask:
    """With a rim around it."""
    import cv2

    return cv2.dilate(mask.astype(np.uint8), disk(radius)).astype(bool)


def shrunk(mask: Mask, radius: int) -> Mask:
    """Without its rim."""
    import cv2

    return cv2.erode(mask.astype(np.uint8), disk(radius)).astype(bool)


def rim(mask: Mask) -> Mask:
    """Its outermost pixels."""
    return mask & ~shrunk(mask, 1)


def main_blob(mask: Mask) -> Mask:
    """The largest connected blob, those that the border cuts off counting less; empty if there is none."""
    import cv2

    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    if count < 2:
        return np.zeros_like(mask)
    border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    cut_off = np.bincount(border, minlength=count) / sum(mask.shape)
    weight = statistics[:, cv2.CC_STAT_AREA] / (1.0 + AT_THE_BORDER * cut_off)
    weight[0] = 0.0
    return np.asarray(labels == int(np.argmax(weight)))


def filled(mask: Mask) -> Mask:
    """With its small holes filled."""
    import cv2

    _, labels, statistics, _ = cv2.connectedComponentsWithStats((~mask).astype(np.uint8), connectivity=4)
    small = statistics[:, cv2.CC_STAT_AREA] <= LARGEST_HOLE * mask.size
    small[0] = False
    return mask | np.isin(labels, np.flatnonzero(small))


def tidy(mask: Mask, thin: int) -> Mask:
    """The main blob without what hangs on it by less than twice ``thin`` pixels, its small holes filled."""
    body = main_blob(opened(main_blob(mask), thin))
    return filled(mask & grown(body, max(1, thin // 2)))


def share_at_border(mask: Mask) -> float:
    """The share of a blob's rim that runs along the picture's border."""
    frame = np.ones_like(mask)
    frame[1:-1, 1:-1] = False
    around = rim(mask) | (mask & frame)  # OpenCV takes what lies outside a picture for part of the mask
    return float((around & frame).sum() / around.sum()) if around.any() else 0.0


SHARPENED = 1.25
"""How far an outline is moved after it was sought in a smaller picture [px of that]."""


def finished(rgb: NDArray[np.uint8], mask: Mask) -> Mask:
    """A mask of a smaller picture, bool, shape (h, w), for the picture itself, uint8, shape (H, W, 3)."""
    shape = (rgb.shape[0], rgb.shape[1])
    reach = max(2, round(SHARPENED * max(shape) / max(mask.shape)))
    return sharpened(rgb, enlarged(mask, shape), reach)


def sharpened(rgb: NDArray[np.uint8], mask: Mask, reach: int) -> Mask:
    """A mask with its outline moved: a pixel there is cloth if it looks more like the cloth than the table beside it.

    Args:
        rgb: the picture, uint8, shape (H, W, 3).
        mask: bool, shape (H, W).
        reach: at most so far [px].
    """
    import cv2

    inner, outer = shrunk(mask, reach), ~grown(mask, reach)
    size = (6 * reach + 1, 6 * reach + 1)
    near, off = [], []
    for part in (inner, outer):
        weight = part.astype(np.float32)
        near.append(cv2.boxFilter(weight, -1, size))
        usual = cv2.boxFilter(rgb * weight[..., None], -1, size) / np.maximum(near[-1], 1e-6)[..., None]
        off.append(np.square(rgb - usual).sum(axis=2))
    known = (near[0] > 1e-3) & (near[1] > 1e-3) & ~inner & ~outer
    moved = np.where(known, off[0] < off[1], mask)
    smooth = cv2.medianBlur(moved.astype(np.uint8), 5).astype(bool)
    return np.where(inner | outer, inner, smooth)


def enlarged(mask: Mask, shape: tuple[int, int]) -> Mask:
    """A mask at another size, shape (H, W), its staircase smoothed away."""
    import cv2

    soft = cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.7)
    return np.asarray(cv2.resize(soft, shape[::-1], interpolation=cv2.INTER_LINEAR) > 0.5)
