"""How the whole garment was moved between two pictures, whether or not a fold took effect."""

from __future__ import annotations

import numpy as np

from polyfold.geometry import iou
from polyfold_agent.recovery.attempt import Attempt, Motion
from polyfold_agent.recovery.cloth import Floats, Mask
from polyfold_agent.recovery.expectation import Expectation

FIT, GAIN = 0.9, 0.05
"""A displacement is believed if it explains the picture this well (IoU), and better than none by this."""

LARGEST_TURN, TURN_STEP = 15.0, 2.5
"""Turns of a displaced garment that are tried [deg]."""

COARSE = 4
"""Displacements are searched on pictures this many times smaller."""


def displacement(attempt: Attempt, mask: Mask) -> Motion:
    """How the garment was moved since an attempt; no motion where that explains little.

    Args:
        attempt: the fold.
        mask: the cloth in the picture after it, bool, shape (H, W).
    """
    outlines = (Expectation.of(attempt).cloth, attempt.mask)
    still = max(iou(outline, mask) for outline in outlines)
    if still >= FIT:
        return Motion()
    fit, motion = max((_registered(outline, mask) for outline in outlines), key=lambda found: found[0])
    return motion if fit >= max(FIT, still + GAIN) else Motion()


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
        return [Motion.carrying(centre, goal, float(np.radians(turn))) for turn in turns]

    coarse = max(motions(np.arange(-LARGEST_TURN, LARGEST_TURN + 1e-6, TURN_STEP)), key=fit)
    turns = np.degrees(coarse.angle) + np.linspace(-TURN_STEP, TURN_STEP, 9)
    best = max(motions(turns), key=fit)
    return fit(best), best
