"""What the camera saw of the cloth, prepared for fitting: contour samples and a signed distance field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GroundingError
from polyfold.geometry import contour_of, polygon_area, resample

__all__ = ["Evidence"]

Floats = NDArray[np.float64]

_MARGIN = 80
"""The field reaches this far beyond the image [px], so that starts that stick out are drawn back in."""

_LEAST_AREA = 400.0
"""Fewer pixels of cloth say nothing about its shape [px²]."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """The silhouette to explain.

    Attributes:
        contour: the true edge of the largest blob [px], shape (N, 2).
        samples: evenly spaced points of it [px], shape (S, 2).
        field: distance from the edge [px], negative inside, shape (H + 2 * margin, W + 2 * margin).
        margin: by how much the field exceeds the image on every side [px].
        scale: size of the garment, 1 for one of about 150 x 150 px; lengths in the energy are multiples of it.
    """

    contour: Floats
    samples: Floats
    field: NDArray[np.float32]
    margin: int
    scale: float

    @classmethod
    def of(cls, mask: NDArray[np.bool_], count: int = 300) -> Evidence:
        """Prepare a mask, shape (H, W).

        Raises:
            GroundingError: if there is too little cloth.
        """
        import cv2

        if mask.sum() < _LEAST_AREA:
            raise GroundingError(
                f"only {int(mask.sum())} px of cloth are visible, at least {_LEAST_AREA:.0f} are needed; check the "
                "segmentation and that the garment lies in view of the camera"
            )
        contour = contour_of(mask)
        blob = np.zeros((mask.shape[0] + 2 * _MARGIN, mask.shape[1] + 2 * _MARGIN), np.uint8)
        cv2.fillPoly(blob, [np.round((contour + _MARGIN) * 16).astype(np.int32)], 1, shift=4)
        blob[_MARGIN:-_MARGIN, _MARGIN:-_MARGIN] &= mask
        outside = cv2.distanceTransform(1 - blob, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        inside = cv2.distanceTransform(blob, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        # Distances between pixel centres overshoot the edge, which runs half-way between them.
        field = np.where(blob > 0, 0.5 - inside, outside - 0.5).astype(np.float32)
        scale = float(np.sqrt(abs(polygon_area(contour)))) / 150.0
        return cls(contour, resample(contour, count), field, _MARGIN, scale)
