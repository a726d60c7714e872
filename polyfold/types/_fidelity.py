"""How near a result is to the ideal fold, and what that is worth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Reference = Literal["task", "sentence", "recognised", "self-referenced", "outline"]
"""Who says which fold was wanted: the caller named a task; the sentence is one of a task's own; nobody, and the plan is
recognised as a task's; nobody, and the plan is all there is; or nobody, and of real cloth the outline is all that was
measured."""

Verdict = Literal["good", "fair", "bad"]


@dataclass(frozen=True)
class Fidelity:
    """How near a result is to the ideal fold.

    Attributes:
        iou: of the silhouettes, as the camera sees them.
        moved_part_error_mm: mean distance on the table [mm] between where the particles that the ideal moves by more
            than 20 mm are and where they should be; NaN when it moves none.
        moved: how many particles that are.
        reference: who says which fold was wanted. With ``recognised`` and ``self-referenced`` nobody does: then a wrong
            plan that is executed well scores well. With ``outline`` the outline seen first, folded along the planned
            lines, is what the last one is compared with: plies that slid or were left below are not seen.
        verdict: ``good`` within the strict criterion and of quality 70 or more, ``fair`` within the lenient one and of
            40 or more, else ``bad``; None where they are not installed, and where the sentence contradicts the task.
        quality: graded, 0 to 100; NaN where that metric is not installed.
        contradicted: the task that the sentence is one of, where the caller named another; else empty.
    """

    iou: float
    moved_part_error_mm: float
    moved: int
    reference: Reference
    verdict: Verdict | None = None
    quality: float = math.nan
    contradicted: str = ""

    @property
    def vouched(self) -> bool:
        """Whether anything besides the plan itself says which fold was wanted."""
        return self.reference in ("task", "sentence")

    def in_words(self, task: str | None = None) -> str:
        """Whether the result is good and beside what, in one sentence; no praise where nothing vouches for the plan.

        Args:
            task: the task whose ideal it was compared with, if there is one.
        """
        if self.vouched:
            asked = "which was named" if self.reference == "task" else "which the sentence asks for"
            asked += f", although the sentence asks for {self.contradicted}" if self.contradicted else ""
            return f"{self.verdict or 'compared'}: {self.figures()}; beside the ideal {task}, {asked}"
        if self.reference == "outline":
            return (
                f"{self.figures()}, beside the outline seen first folded along the planned lines; nobody measured "
                "the cloth itself: look at the picture"
            )
        ended = {"bad": "not as planned", "fair": "roughly as planned"}.get(self.verdict or "", "as planned")
        if self.reference == "recognised":
            return (
                f"{ended}: {self.figures()}, beside the ideal {task}, whose lines the plan has; nothing vouches for "
                "this having been meant: look at the picture, or name the task"
            )
        return (
            f"nothing vouches for the plan: it is no known task's, and compared with itself the cloth ended {ended} "
            f"({self.figures()}); look at the picture, or name the task that was meant"
        )

    def figures(self) -> str:
        """How near it came, in figures alone."""
        moved = self.moved_part_error_mm
        off = "" if math.isnan(moved) else f", moved part off by {moved:.1f} mm"
        quality = "" if math.isnan(self.quality) else f", quality {self.quality:.0f} of 100"
        return f"IoU {self.iou:.3f}{off}{quality}"
