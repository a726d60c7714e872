"""What the picture should look like after a fold, and where the one that is seen differs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import FoldLine
from polyfold_agent.recovery.attempt import Attempt
from polyfold_agent.recovery.cloth import Floats, Mask, heights, inside, near

PLACE_RADIUS = 14.0
"""Neighbourhood of a place in which the flap's height is measured [px]."""

THINNEST = 1e-5
"""Thinner cloth is none: the depth image's rounding [m]."""

MOST = 2.0
"""No pixel proves more than this: plies of half a millimetre bulge by many times their thickness. Two is what a single
ply gives: the picture shows its middle, so that it seems half as high while it lies on the table."""

SPECK = 5
"""Unexpected cloth narrower than this [px] is the outline's uncertainty."""


@dataclass(frozen=True, eq=False)
class Expectation:
    """The picture that a fold should lead to.

    Attributes:
        cloth: where cloth should be, bool, shape (H, W).
        flap: where the flap should have landed, bool, shape (H, W).
        base: height without the flap [m], shape (H, W).
        height: height with the flap [m], shape (H, W).
    """

    cloth: Mask
    flap: Mask
    base: NDArray[np.float32]
    height: NDArray[np.float32]

    @classmethod
    def of(cls, attempt: Attempt) -> Expectation:
        """The picture before an attempt, folded along its line."""
        import cv2

        height, width = attempt.mask.shape
        y, x = np.mgrid[:height, :width]
        lifted = attempt.line.distance(np.stack([x, y], axis=-1)) > 0
        before = heights(attempt.observation, attempt.mask)
        across = _reflection(attempt.line)
        flap = cv2.warpAffine(
            (lifted & attempt.mask).astype(np.uint8), across, (width, height), flags=cv2.INTER_NEAREST
        )
        base = np.where(lifted, np.float32(0.0), before)
        above = cv2.warpAffine(np.where(lifted, before, np.float32(0.0)), across, (width, height))
        cloth = (attempt.mask & ~lifted) | (flap > 0)
        return cls(cloth, flap > 0, base, base + np.asarray(above, np.float32))

    def landed(self, seen: NDArray[np.float32], place: Floats) -> float:
        """How much of the flap came down around a place: 0 where nothing did, 1 to 2 where all did.

        Args:
            seen: height of the cloth now [m], shape (H, W).
            place: where an arm let go [px], shape (2,).
        """
        thickness = self.height - self.base
        around = near(place, PLACE_RADIUS, self.flap & (thickness > THINNEST))
        if not around.any():
            return 1.0
        shares = (seen - self.base)[around] / thickness[around]
        return float(np.clip(shares, 0.0, MOST).mean())

    def tip(self, mask: Mask) -> tuple[Floats, float]:
        """The cloth farthest beyond the expected outline: a pixel a little inside it, shape (2,), and how far [px]."""
        import cv2

        surplus = cv2.morphologyEx((mask & ~self.cloth).astype(np.uint8), cv2.MORPH_OPEN, np.ones((SPECK, SPECK)))
        beyond = cv2.distanceTransform((~self.cloth).astype(np.uint8), cv2.DIST_L2, 5) * surplus
        row, column = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
        return inside(mask, np.array([column, row], float)), float(beyond.max())


def _reflection(line: FoldLine) -> Floats:
    """Mirroring across a line as OpenCV's affine map, shape (2, 3)."""
    origin, right, down = line.mirror([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    return np.column_stack([right - origin, down - origin, origin])
