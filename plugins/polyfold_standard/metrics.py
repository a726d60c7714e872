"""Metrics of an outcome against references made by the oracle (paper, Sec. V-C)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import iou
from polyfold.scoring import Outcome

__all__ = ["MPPE", "MIoU", "MovedPartError"]

Floats = NDArray[np.float64]


class MPPE:
    """Mean particle position error [mm]: mean distance of corresponding particles, best of the references."""

    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        align: bool = Field(False, description="move and turn the result rigidly onto the reference first")

    def __init__(self, config: Config | None = None) -> None:
        self._align = (config or self.Config()).align

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The error against the nearest reference."""
        return min(self._against(result, reference) for reference in references)

    def _against(self, result: Outcome, reference: Outcome) -> float:
        positions = result.end.positions
        if self._align:
            positions = _aligned(positions, reference.end.positions)
        return 1000.0 * float(np.linalg.norm(positions - reference.end.positions, axis=1).mean())


class MIoU:
    """IoU of the silhouettes as the camera sees them, best of the references."""

    unit: ClassVar[str] = ""
    higher_is_better: ClassVar[bool] = True

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The overlap with the nearest reference."""
        return max(iou(result.mask, reference.mask) for reference in references)


class MovedPartError:
    """Mean distance [mm] over the particles that the reference moved by more than 20 mm; doing nothing can't pass."""

    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        moved_mm: float = Field(20.0, gt=0, description="travel in the reference from which a particle counts [mm]")

    def __init__(self, config: Config | None = None) -> None:
        self._moved = (config or self.Config()).moved_mm / 1000.0

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The error against the nearest reference; NaN if that moved nothing."""
        return min(self._against(result, reference) for reference in references)

    def _against(self, result: Outcome, reference: Outcome) -> float:
        travel = np.linalg.norm(reference.end.positions - reference.start.positions, axis=1)
        moved = travel > self._moved
        if not moved.any():
            return float("nan")
        return 1000.0 * float(np.linalg.norm((result.end.positions - reference.end.positions)[moved], axis=1).mean())


def _aligned(points: Floats, target: Floats) -> Floats:
    """Points [m], shape (N, 3), turned about the vertical and moved to fit ``target`` best (Kabsch in the plane)."""
    centre, goal = points.mean(axis=0), target.mean(axis=0)
    a, b = (points - centre)[:, :2], (target - goal)[:, :2]
    angle = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    c, s = np.cos(angle), np.sin(angle)
    turned = (points - centre) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return turned + goal
