"""The directed fold line: what is on its left is lifted."""

from __future__ import annotations

import math
import reprlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import PlanError
from polyfold.geometry import _plane as geometry

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FoldLine:
    """A directed fold line. The cloth to its LEFT, as seen in the image, is lifted and mirrored across it.

    Attributes:
        start: x and y where it begins [px].
        end: x and y where it ends [px].

    Raises:
        PlanError: if one is no finite pixel, or both are the same.
    """

    start: tuple[float, float]
    end: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            object.__setattr__(self, name, _pixel(getattr(self, name), f"the {name}"))
        if self.start == self.end:
            x, y = self.start
            raise PlanError(
                f"a fold line goes from one pixel to another, and both are ({x:g}, {y:g}); choose two points apart"
            )

    @classmethod
    def between(cls, start: ArrayLike, end: ArrayLike) -> FoldLine:
        """The line from one point to another [px], each of shape (2,)."""
        return cls(_pixel(start, "the start"), _pixel(end, "the end"))

    @classmethod
    def moving(cls, pick: ArrayLike, place: ArrayLike) -> FoldLine:
        """The line that carries ``pick`` onto ``place`` [px], each of shape (2,): their perpendicular bisector.

        Raises:
            PlanError: if one is no finite pixel, or both are the same.
        """
        start, end = _pixel(pick, "the pick"), _pixel(place, "the place")
        if start == end:
            raise PlanError(
                f"pick and place are both at ({start[0]:g}, {start[1]:g}), so no line lies between them; "
                "choose two points apart"
            )
        return cls.between(*geometry.perpendicular_bisector(start, end))

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


def _pixel(point: Any, name: str) -> tuple[float, float]:
    try:
        x, y = (float(coordinate) for coordinate in point)
    except (TypeError, ValueError):
        raise PlanError(
            f"{name} of a fold line is a pixel (x, y), not {reprlib.repr(point)}; give two numbers"
        ) from None
    if not (math.isfinite(x) and math.isfinite(y)):
        raise PlanError(f"{name} of a fold line is a finite pixel (x, y), not ({x:g}, {y:g}); give two numbers")
    return x, y
