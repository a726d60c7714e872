"""The best of several masks: those of little and much light, of fine and coarse cloth; and what speaks against it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GroundingError
from polyfold_standard.segmenters.blobs import (
    closed,
    grown,
    opened,
    rim,
    share_at_border,
    shrunk,
    tidy,
)
from polyfold_standard.segmenters.light import border_band

Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]

WORKING_SIZE = 400
"""Longer side of the picture that masks are sought in [px]; lengths here are in its pixels."""

LIGHTS = (0.3, 0.12, 0.06)
"""How much the light may vary, from shadows and sun spots to hardly at all; the first is preferred."""

STRICTER = 0.05
"""What a mask of the next stricter light must be better by."""

GAPS = (2, 6)
"""Gaps that are closed in cloth of several colours [px]; the first is preferred."""

COARSER = 0.02
"""What a mask with wider gaps closed must be better by."""

SHARPNESS = 0.2
"""Weight of how sharp an outline is beside how much of it is to be seen."""

CUTS = 2
"""Rounds of GrabCut, which finds where exactly the cloth ends."""

REACH = 12
"""How far GrabCut may move an outline outwards [px]."""

SEEN = 0.8
"""Of a garment at least this share of the outline is to be seen; of blobs of texture, at most half."""

PART = 2 / 3
"""Another thing that is larger than this share of the largest makes it doubtful which is meant."""

NOTHING = (
    "no cloth stands out from the table; crop the picture to the table around the cloth, use a plain background of "
    "another colour, or give a box or a mask"
)
SEVERAL = (
    "there are several things on the table; take one away, crop the picture, use a plain background, or give a mask"
)


@dataclass(frozen=True, eq=False)
class Candidate:
    """One mask at the working size.

    Attributes:
        mask: bool, shape (h, w).
        light: in which it was found.
        seen: the share of its outline that is to be seen, 0 to 1.
        worth: what it is chosen by.
        things: blobs of the mask it was taken from, in pixels, largest first.
    """

    mask: Mask
    light: float
    seen: float
    worth: float
    things: tuple[int, ...]


def reduced(rgb: Picture) -> Picture:
    """The picture at the working size, or as it is if that is smaller."""
    import cv2

    height, width = rgb.shape[:2]
    scale = WORKING_SIZE / max(height, width)
    if scale >= 1.0:
        return rgb
    size = (max(16, round(width * scale)), max(16, round(height * scale)))
    return np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8)


def smoothed(small: Picture) -> Picture:
    """Without noise and fine grain, its edges kept."""
    import cv2

    return np.asarray(cv2.bilateralFilter(small, 7, 25, 5), np.uint8)


def candidates(small: Picture, unlike_table: Callable[[float], Floats], thin: int) -> Iterator[Candidate]:
    """Masks of what is unlike the table, in every light and with and without wider gaps closed.

    Args:
        small: the picture at the working size, uint8, shape (h, w, 3).
        unlike_table: light -> how unlike the table each pixel is, shape (h, w).
        thin: what is thinner than twice this is no cloth [px].
    """
    band = border_band(small.shape[:2])
    slopes = slopes_of(small)
    for strictness, light in enumerate(LIGHTS):
        distance = unlike_table(light)
        limit = _limit(distance, float(np.percentile(distance[band], 90)))
        found = opened(distance > limit, 1)
        for coarseness, gap in enumerate(GAPS):
            joined = closed(found, gap)
            things = _areas(opened(joined, thin))
            rough = tidy(joined, thin)
            for mask in (rough, tidy(cut(small, rough, distance, limit), thin)):
                seen, sharp = outline_seen(slopes, mask)
                worth = seen + SHARPNESS * sharp - STRICTER * strictness - COARSER * coarseness
                yield Candidate(mask, light, seen, worth, things)


def best(found: list[Candidate], smallest: float) -> Candidate:
    """The best of them that covers enough of the picture. Raises GroundingError if none is good."""
    large = [candidate for candidate in found if candidate.mask.mean() >= smallest]
    chosen = max(large, key=lambda candidate: candidate.worth, default=None)
    if chosen is None or chosen.seen < SEEN:
        raise GroundingError(NOTHING)
    if share_at_border(chosen.mask) > 0.5:
        raise GroundingError("what stands out fills the picture; show the whole cloth with table around it")
    if len(chosen.things) > 1 and chosen.things[1] > PART * chosen.things[0]:
        raise GroundingError(SEVERAL)
    return chosen


def slopes_of(small: Picture) -> Floats:
    """How steeply colours change [RGB units per px], shape (h, w)."""
    import cv2

    soft = cv2.GaussianBlur(small, (0, 0), 1.2).astype(np.float32)
    across, down = (cv2.Sobel(soft, cv2.CV_32F, *order, ksize=3) / 8 for order in ((1, 0), (0, 1)))
    return np.sqrt((across**2 + down**2).max(axis=2))


def outline_seen(slopes: Floats, mask: Mask) -> tuple[float, float]:
    """The share of a mask's outline where colours change more than they do on the table, and how sharp it is, 0 to 3.

    Args:
        slopes: as of :func:`slopes_of`, shape (h, w).
        mask: bool, shape (h, w).
    """
    import cv2

    around = rim(mask)
    if not around.any():
        return 0.0, 0.0
    outside = ~grown(mask, 6)
    usual = max(2.0, float(np.percentile(slopes[outside], 90))) if outside.any() else 2.0
    nearby = cv2.dilate(slopes, np.ones((5, 5), np.uint8))
    return float((nearby[around] > usual).mean()), float(np.clip(slopes[around] / usual, 0, 3).mean())


def cut(small: Picture, mask: Mask, distance: Floats, limit: float) -> Mask:
    """A mask whose outline GrabCut has moved to where the cloth ends."""
    import cv2

    near = grown(mask, 4)
    labels = np.full(mask.shape, cv2.GC_PR_BGD, np.uint8)
    labels[mask] = cv2.GC_PR_FGD
    labels[shrunk(mask, 4) & (distance > limit)] = cv2.GC_FGD
    labels[~grown(mask, REACH) | ((distance < 0.5 * limit) & ~near) | border_band(mask.shape)] = cv2.GC_BGD
    if not (labels == cv2.GC_FGD).any():
        return mask
    cv2.setRNGSeed(0)
    cv2.grabCut(small, labels, (0, 0, 1, 1), np.zeros((1, 65)), np.zeros((1, 65)), CUTS, cv2.GC_INIT_WITH_MASK)
    return np.asarray((labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD))


def _limit(distance: Floats, noise: float) -> float:
    """How unlike the table cloth is: where Otsu divides, and beyond the table's own noise."""
    import cv2

    top = 12.0 * noise
    scaled = np.clip(distance * (255.0 / top), 0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(scaled, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return max(0.8 * otsu * top / 255.0, 1.5 * noise)


def _areas(mask: Mask) -> tuple[int, ...]:
    """Areas [px] of the blobs that the border does not cut off, largest first."""
    import cv2

    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    border = np.unique(np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]]))
    inner = [int(statistics[label, cv2.CC_STAT_AREA]) for label in range(1, count) if label not in border]
    return tuple(sorted(inner, reverse=True))
