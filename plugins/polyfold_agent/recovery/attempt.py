"""A fold that was tried, and rigid motions of what it was tried on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from polyfold.geometry import FoldLine, rotate
from polyfold.types import Action, Observation
from polyfold_agent.recovery.cloth import Floats, Mask, reach


@dataclass(frozen=True)
class Motion:
    """A rigid motion in the image: a turn about ``centre`` [rad, x towards y], then a shift [px]."""

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def carrying(cls, centre: Floats, target: Floats, angle: float) -> Motion:
        """The motion that turns about ``centre`` and lays it on ``target`` [px], both of shape (2,)."""
        (x, y), (dx, dy) = centre, target - centre
        return cls(angle, (float(dx), float(dy)), (float(x), float(y)))

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
        observation: the picture before the fold.
        mask: the cloth in it, bool, shape (H, W).
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
        return reach(self.mask, self.line)

    def moved(self, motion: Motion) -> Attempt:
        """The same attempt as if the garment had lain elsewhere."""
        import cv2

        if motion == Motion():
            return self
        height, width = self.mask.shape
        seen, elevation = self.observation, self.observation.camera.elevation
        mask = cv2.warpAffine(self.mask.astype(np.uint8), motion.matrix(), (width, height), flags=cv2.INTER_NEAREST)
        depth = cv2.warpAffine(seen.depth, motion.matrix(), (width, height), borderValue=elevation)
        limit = np.array([width - 1.0, height - 1.0])
        picks, places = (np.clip(motion.points(p), 0.0, limit) for p in (self.action.picks, self.action.places))
        observation = Observation(seen.rgb, np.asarray(depth, np.float32), seen.camera)
        return Attempt(observation, mask > 0, motion.line(self.line), Action(picks, places))
