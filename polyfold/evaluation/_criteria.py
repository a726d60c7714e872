"""Scores: how near an episode's end is to a reference, and which results count as success.

The paper names MPPE, mIoU and a success rate over thresholds that it does not publish (Sec. V-C). Ours are the presets
below, side by side; the moved-part error is added because an untouched garment scores well on the other two where the
moved part is small.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Threshold:
    """A bound on a metric: at most ``bound`` where lower is better, at least ``bound`` where higher is."""

    metric: str
    bound: float
    higher_is_better: bool = False

    def holds(self, value: float) -> bool:
        """Whether a value meets the bound; NaN (nothing to measure) does."""
        return bool(np.isnan(value) or (value >= self.bound if self.higher_is_better else value <= self.bound))

    def share(self, value: float) -> float:
        """How much of what the bound allows a value takes up: an error of its bound, an overlap of what may miss to 1.

        NaN (nothing to measure) takes up nothing; at most 1 meets the bound.
        """
        if np.isnan(value):
            return 0.0
        return (1.0 - value) / (1.0 - self.bound) if self.higher_is_better else value / self.bound


PRESETS: Mapping[str, Sequence[Threshold]] = {
    "polyfold": (
        Threshold("miou", 0.80, higher_is_better=True),
        Threshold("mppe", 30.0),
        Threshold("moved-part", 40.0),
    ),
    "strict": (
        Threshold("miou", 0.90, higher_is_better=True),
        Threshold("mppe", 12.5),
        Threshold("moved-part", 20.0),
    ),
}
"""What counts as success: ``polyfold`` is ours, ``strict`` asks for twice a particle radius as LangDef and BiFold."""


def succeeded(values: Mapping[str, float], preset: str = "polyfold") -> bool:
    """Whether metric values meet every threshold of a preset."""
    return all(threshold.holds(values[threshold.metric]) for threshold in PRESETS[preset])


def needed_scale(values: Mapping[str, float]) -> float:
    """The factor on what the thresholds of ``polyfold`` allow at which metric values just meet them: 0 is perfect."""
    return max(threshold.share(values[threshold.metric]) for threshold in PRESETS["polyfold"])
