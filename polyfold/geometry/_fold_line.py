"""The directed fold line: what is on its left is lifted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import _plane as geometry

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FoldLine:
    """A directed fold line. The cloth to its LEFT, as seen in the image, is lifted and mirrored across it.

    Attributes:
        start: x and y where it begins [px].
        end: x and y where it ends [px].
    """

    start: tuple[float, float]
    end: tuple[float, float]

    @classmethod
    def between(cls, start: ArrayLike, end: ArrayLike) -> FoldLine:
        """The line from one point to another [px], each of shape (2,)."""
        (x0, y0), (x1, y1) = np.asarray(start, float), np.asarray(end, float)
        return cls((float(x0), float(y0)), (float(x1), float(y1)))

    @classmethod
    def moving(cls, pick: ArrayLike, place: ArrayLike) -> FoldLine:
        """The line that carries ``pick`` onto ``place`` [px], each of shape (2,): their perpendicular bisector."""
        return cls.between(*geometry.perpendicular_bisector(pick, place))

    @property
    def length(self) -> float:
        """Distance from start to end [px]."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    def lifts(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which points [px], shape (..., 2), are on the lifted (left) side, bool, shape (...,)."""
        return geometry.left_of(points, self.start, self.end)

    def distance(self, points: ArrayLike) -> Floats:
        """Signed distance [px], shape (...,), of points [px], shape (..., 2); positive on the lifted side."""
        return geometry.signed_distance(points, self.start, self.end)

    def mirror(self, points: ArrayLike) -> Floats:
        """Points [px], shape (..., 2), reflected across the line."""
        return geometry.mirror(points, self.start, self.end)

    def fold(self, points: ArrayLike) -> Floats:
        """Points [px], shape (..., 2), after the fold: mirrored where they are lifted, else where they were."""
        points = np.asarray(points, float)
        return np.where(self.lifts(points)[..., None], self.mirror(points), points)

    def shifted(self, distance: float) -> FoldLine:
        """The parallel line ``distance`` [px] further to the lifted (left) side."""
        along = np.subtract(self.end, self.start) / self.length
        shift = distance * np.array([along[1], -along[0]])
        return FoldLine.between(self.start + shift, self.end + shift)

    def reversed(self) -> FoldLine:
        """The same line with the other side lifted."""
        return FoldLine(self.end, self.start)
