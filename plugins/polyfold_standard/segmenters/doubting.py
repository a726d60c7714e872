"""What speaks against a mask, and what of the cloth looks like table in another light."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from polyfold_standard.segmenters.blobs import enlarged, grown, opened, rim, share_at_border, shrunk
from polyfold_standard.segmenters.choosing import (
    LIGHTS,
    Candidate,
    outline_seen,
    reduced,
    slopes_of,
    smoothed,
)
from polyfold_standard.segmenters.light import border_band, colours_of, unlike

Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]

LEAST_INLAY = 0.005
"""Parts of a smaller share of the cloth are left as they are."""

SPANNED = 0.9
"""A part is an inlay if so much of it lies within the convex hull of the rest."""

LIGHT_ALONE = 0.08
"""Of cloth, at most this share may have a colour that the table has in other light, without a doubt."""


LEFT_OUT = 0.04
"""Larger parts beside a mask, as a share of it, are worth a doubt ..."""

UNLIKE = 2.0
"""What differs by so much of the border's own noise may be cloth: a grey yoke beside a body of a strong colour."""

SHARPLY = 0.3
"""... if their edge is at least so steep, as a share of the mask's own."""


def with_inlays(small: Picture, chosen: Candidate, found: Sequence[Candidate]) -> Mask:
    """A mask with those parts that look like table in a shadow, but lie between its parts and end sharply.

    A grey print on a coloured shirt is one, on a grey table. What is brighter than the table may be sun between two
    legs, and what sticks out may be a shadow: they are left to doubts.

    Args:
        small: the picture at the working size, uint8, shape (h, w, 3).
        chosen: what was found.
        found: all candidates, among them those in light that varies less.
    """
    import cv2

    stricter = [candidate for candidate in found if candidate.light < chosen.light]
    if not stricter:
        return chosen.mask
    mask, slopes = chosen.mask, slopes_of(small)
    nearby, grey = cv2.dilate(slopes, np.ones((5, 5), np.uint8)), small.mean(axis=2)
    usual = float(np.median(slopes[rim(mask)]))
    added = opened(max(stricter, key=lambda candidate: candidate.worth).mask & ~mask, 2)
    count, labels = cv2.connectedComponents(added.astype(np.uint8))
    for label in range(1, count):
        part = np.asarray(labels == label)
        new_edge = rim(mask | part) & grown(part, 1) & ~grown(mask, 3)
        beside = grown(part, 8) & ~grown(mask | part, 2)
        if part.sum() < LEAST_INLAY * mask.sum() or not new_edge.any() or not beside.any():
            continue
        between = (part & _hull(mask)).sum() >= SPANNED * part.sum()
        if between and np.median(nearby[new_edge]) > usual and np.median(grey[part]) < np.median(grey[beside]):
            mask = mask | part
    return mask


def doubts_about(rgb: Picture, mask: Mask) -> tuple[str, ...]:
    """What speaks against a mask, bool, shape (H, W), of a picture, uint8, shape (H, W, 3): one line each."""
    small = reduced(rgb)
    less = enlarged(mask, small.shape[:2])
    found = []
    seen, _ = outline_seen(slopes_of(small), less)
    if seen < 0.9:
        found.append(f"along {1 - seen:.0%} of the outline nothing sets the cloth apart from the table")
    if (cut_off := share_at_border(less)) > 0.02:
        found.append(f"the picture's border cuts the cloth off along {cut_off:.0%} of its outline")
    if (share := _light_alone(small, less)) > LIGHT_ALONE:
        found.append(
            f"{share:.0%} of the cloth has a colour of the table in other light; it may be a shadow or a sun spot"
        )
    if (more := _left_out(small, less)) > LEFT_OUT:
        found.append(
            f"beside it {more:.0%} more end sharply and differ from the table only as in other light; is it cloth?"
        )
    return tuple(found)


def _left_out(small: Picture, mask: Mask) -> float:
    """How large a part beside a mask is, as a share of it, that ends sharply but may be a shadow or a sun spot."""
    import cv2

    soft, slopes = smoothed(small), slopes_of(small)
    band = border_band(small.shape[:2])
    distance = unlike(soft, colours_of(soft[band]), LIGHTS[-1])
    limit = UNLIKE * float(np.percentile(distance[band], 90))
    added = opened((distance > limit) & ~grown(mask, 2), 3)
    nearby, usual = cv2.dilate(slopes, np.ones((5, 5), np.uint8)), float(np.median(slopes[rim(mask)]))
    count, labels = cv2.connectedComponents(added.astype(np.uint8))
    largest = 0.0
    for label in range(1, count):
        part = np.asarray(labels == label)
        new_edge = rim(part) & ~grown(mask, 5)
        if (grown(part, 4) & mask).any() and new_edge.any() and np.median(nearby[new_edge]) > SHARPLY * usual:
            largest = max(largest, float(part.sum() / mask.sum()))
    return largest


def _light_alone(small: Picture, mask: Mask) -> float:
    """The share of a mask that differs from the table as other light would make it."""
    soft = smoothed(small)
    inner = shrunk(mask, 3)
    if not inner.any():
        return 0.0
    table = colours_of(soft[border_band(small.shape[:2])])
    distance = unlike(soft, table, 0.6)
    noise = float(np.percentile(distance[border_band(small.shape[:2])], 90))
    return float((opened(distance < max(1.5, 1.5 * noise), 1) & inner).sum() / inner.sum())


def _hull(mask: Mask) -> Mask:
    import cv2

    points = np.argwhere(mask)[:, ::-1].astype(np.int32)
    filled = np.zeros(mask.shape, np.uint8)
    cv2.fillConvexPoly(filled, cv2.convexHull(points), 1)
    return filled.astype(bool)
