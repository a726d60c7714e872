"""How near a result is to the ideal fold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Reference = Literal["keypoints", "self-referenced"]


@dataclass(frozen=True)
class Fidelity:
    """How near a result is to the ideal fold.

    Attributes:
        iou: of the silhouettes, as the camera sees them.
        moved_part_error_mm: mean distance on the table [mm] between where the particles that the ideal moves by more
            than 20 mm are and where they should be; NaN when it moves none.
        moved: how many particles that are.
        reference: ``keypoints`` when the ideal lines come from a task and the true keypoints, ``self-referenced`` when
            they are the lines that were planned: then a wrong plan that is executed well scores well.
    """

    iou: float
    moved_part_error_mm: float
    moved: int
    reference: Reference
