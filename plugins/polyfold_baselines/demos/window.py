"""What baselines look at: the square of the camera's picture about the garment as it first lay, at one size for all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GroundingError
from polyfold.geometry import Camera

Floats = NDArray[np.float64]

SIDE = 128
"""Pixels of a view along each axis."""
MARGIN = 1.3
"""The window's side over the garment's longer one."""


@dataclass(frozen=True)
class Window:
    """A square of the camera's picture.

    Attributes:
        centre: its middle [px], x and y.
        side: of it [px].
    """

    centre: tuple[float, float]
    side: float

    @classmethod
    def around(cls, mask: NDArray[np.bool_]) -> Window:
        """The window about a garment, bool, shape (H, W). Raises GroundingError if there is none."""
        rows, columns = np.nonzero(mask)
        if not len(rows):
            raise GroundingError("there is no cloth to look at; lay a garment on the table")
        low, high = np.array([columns.min(), rows.min()]), np.array([columns.max(), rows.max()])
        x, y = ((low + high) / 2).tolist()
        return cls((x, y), MARGIN * float((high - low).max() + 1))

    def to_view(self, pixels: ArrayLike) -> Floats:
        """Points of the camera's picture [px], shape (N, 2), in the view, from 0 to :data:`SIDE`."""
        return (np.asarray(pixels, float) - self.centre) * (SIDE / self.side) + (SIDE - 1) / 2

    def to_pixels(self, points: ArrayLike) -> Floats:
        """Points of the view, shape (N, 2), in the camera's picture [px]."""
        return (np.asarray(points, float) - (SIDE - 1) / 2) * (self.side / SIDE) + self.centre

    def extent(self, camera: Camera) -> float:
        """Its side on the table [m]."""
        return self.side / camera.pixels_per_metre

    def view(self, picture: NDArray, outside: float = 0.0) -> NDArray[np.float32]:
        """A picture or mask, shape (H, W), through the window, shape (SIDE, SIDE): means of what each pixel covers."""
        import cv2

        scale = SIDE / self.side
        # Finer than the view first, then averaged, so that a thin edge is neither lost nor doubled.
        fine = 2
        x, y = self.centre
        shift = np.array([[1.0, 0.0, -x], [0.0, 1.0, -y]]) * scale * fine
        shift[:, 2] += (SIDE * fine - 1) / 2
        seen = cv2.warpAffine(
            np.asarray(picture, np.float32), shift, (SIDE * fine, SIDE * fine), flags=cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT, borderValue=outside,
        )  # fmt: skip
        return np.asarray(seen, np.float32).reshape(SIDE, fine, SIDE, fine).mean((1, 3))


def on_table(points: ArrayLike, extent: float) -> Floats:
    """Points of a view, shape (..., 2), seen from its middle on the table [m]: x right, y down.

    Args:
        points: from 0 to :data:`SIDE`.
        extent: side of the window on the table [m].
    """
    return (np.asarray(points, float) - (SIDE - 1) / 2) * (extent / SIDE)


def in_view(points: ArrayLike, extent: float) -> Floats:
    """Points on the table, as :func:`on_table` has them, in the view again."""
    return np.asarray(points, float) * (SIDE / extent) + (SIDE - 1) / 2


def on_cloth(points: ArrayLike, mask: NDArray[np.bool_]) -> Floats:
    """The nearest pixels of the cloth, bool, shape (H, W), to points of the camera's picture [px], shape (N, 2)."""
    cloth = np.argwhere(mask)[:, ::-1].astype(float)
    return np.array([cloth[np.argmin(np.hypot(*(cloth - point).T))] for point in np.asarray(points, float)])
