"""The camera: the only converter between pixels and metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Camera:
    """A pinhole camera that looks straight down; its optical axis meets the table at the world's origin.

    Attributes:
        width, height: image size [px].
        focal: focal length [px].
        elevation: height of the pinhole above the table [m].
    """

    width: int = 400
    height: int = 400
    focal: float = 800.0
    elevation: float = 2.0

    @classmethod
    def framing(cls, extent: float, width: int = 400, height: int = 400, elevation: float = 2.0) -> Camera:
        """The camera whose image shows ``extent`` metres of the table along its shorter side."""
        return cls(width, height, min(width, height) * elevation / extent, elevation)

    @property
    def centre(self) -> tuple[float, float]:
        """Principal point [px]."""
        return (self.width - 1) / 2, (self.height - 1) / 2

    @property
    def pixels_per_metre(self) -> float:
        """Image scale at the height of the table [px/m]."""
        return self.focal / self.elevation

    def to_pixels(self, points: ArrayLike) -> Floats:
        """Project world points [m], shape (..., 2) on the table or (..., 3), to pixels, shape (..., 2)."""
        points = np.asarray(points, float)
        depth = self.elevation - (points[..., 2] if points.shape[-1] == 3 else 0.0)
        scale = self.focal / depth
        return np.stack([self.centre[0] + points[..., 0] * scale, self.centre[1] - points[..., 1] * scale], axis=-1)

    def to_world(self, pixels: ArrayLike, z: ArrayLike = 0.0) -> Floats:
        """World points [m], shape (..., 3), seen at pixels, shape (..., 2), at height ``z`` [m] above the table."""
        pixels, z = np.asarray(pixels, float), np.asarray(z, float)
        scale = (self.elevation - z) / self.focal
        x = (pixels[..., 0] - self.centre[0]) * scale
        y = (self.centre[1] - pixels[..., 1]) * scale
        return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)
