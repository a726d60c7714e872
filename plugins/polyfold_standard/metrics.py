"""Metrics of an outcome against references (paper, Sec. V-C)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.geometry import iou
from polyfold.types import Outcome
from polyfold_standard.alignment import Alignable, Aligning, laid_onto

Floats = NDArray[np.float64]


class MPPE(Aligning):
    """Mean particle position error [mm]: mean distance of corresponding particles, best of the references."""

    label: ClassVar[str] = "MPPE"
    digits: ClassVar[int] = 1
    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The error against the nearest reference."""
        return min(float(_errors(result, reference, self._align).mean()) for reference in references)


class IoU(Aligning):
    """IoU of the silhouettes as the camera sees them, best of the references (mIoU: its mean over episodes)."""

    label: ClassVar[str] = "mIoU"
    digits: ClassVar[int] = 3
    unit: ClassVar[str] = ""
    most: ClassVar[float] = 1.0
    higher_is_better: ClassVar[bool] = True

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The overlap with the nearest reference."""
        return max(iou(self._mask(result, reference), reference.mask) for reference in references)

    def _mask(self, result: Outcome, reference: Outcome) -> NDArray[np.bool_]:
        return _aligned_mask(result, reference) if self._align else result.mask


class MovedPartError:
    """Mean distance [mm] over the particles that the reference moved by more than 20 mm; doing nothing can't pass."""

    label: ClassVar[str] = "moved part"
    digits: ClassVar[int] = 1
    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    class Config(Alignable):
        """Parameters."""

        moved_mm: float = Field(
            default=20.0, gt=0, description="travel in the reference from which a particle counts [mm]"
        )

    def __init__(self, config: Config | None = None) -> None:
        config = config or self.Config()
        self._align, self._moved = config.align, config.moved_mm / 1000.0

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The error against the nearest reference; NaN if that moved nothing."""
        return min(self._against(result, reference) for reference in references)

    def _against(self, result: Outcome, reference: Outcome) -> float:
        travel = np.linalg.norm(reference.end.positions - reference.start.positions, axis=1)
        moved = travel > self._moved
        return float(_errors(result, reference, self._align)[moved].mean()) if moved.any() else float("nan")


def _errors(result: Outcome, reference: Outcome, align: bool) -> Floats:
    """Distance [mm] of every particle from where the reference has it, shape (N,)."""
    positions, wanted = result.end.positions, reference.end.positions
    if align:
        positions = np.column_stack([laid_onto(positions, wanted, positions[:, :2]), positions[:, 2]])
    return 1000.0 * np.linalg.norm(positions - wanted, axis=1)


def _aligned_mask(result: Outcome, reference: Outcome) -> NDArray[np.bool_]:
    """The result's silhouette as the camera would see it after the rigid motion that fits its particles best."""
    import cv2

    camera = result.end.camera
    corners = np.array([[0.0, 0.0], [camera.width, 0.0], [0.0, camera.height]])
    on_table = camera.to_world(corners)[:, :2]
    moved = camera.to_pixels(laid_onto(result.end.positions, reference.end.positions, on_table))
    matrix = cv2.getAffineTransform(corners.astype(np.float32), moved.astype(np.float32))
    size = (camera.width, camera.height)
    return cv2.warpAffine(result.mask.astype(np.uint8), matrix, size, flags=cv2.INTER_NEAREST).astype(bool)
