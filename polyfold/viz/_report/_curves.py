"""How success depends on the thresholds, so that no choice of them hides anything."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from polyfold.analysis import share
from polyfold.analysis._columns import shared
from polyfold.evaluation._criteria import needed_scale
from polyfold.logs import StudyEpisodeRecord
from polyfold.types import Threshold

SCALES = tuple(float(scale) for scale in np.linspace(0.25, 2.0, 36))
"""Factors on the thresholds of the study's own criterion."""


@dataclass(frozen=True)
class Curve:
    """Share of successes with thresholds scaled by ``SCALES``.

    Attributes:
        shares, low, high: share and its 95 % interval, 0 to 1, one per scale; NaN without episodes.
        n: number of episodes.
    """

    shares: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    n: int


def success_curve(records: Sequence[StudyEpisodeRecord], thresholds: Sequence[Threshold]) -> Curve:
    """Success of episodes as all thresholds of a criterion are loosened or tightened together.

    Bounds on errors are multiplied; of a bound on an overlap, what may be missing to 1 is. An episode that ended early
    never succeeds; a goal that is done by its own bounds does with any thresholds.
    """
    needed = np.array([smallest_scale(record, thresholds) for record in records])
    found = [share((needed <= scale + 1e-9).tolist(), *shared(records)) for scale in SCALES]
    shares, low, high = (
        tuple(values) for values in zip(*((e.mean / 100, e.low / 100, e.high / 100) for e in found), strict=True)
    )
    return Curve(shares, low, high, len(records))


def scaled(threshold: Threshold, scale: float) -> Threshold:
    """A threshold loosened or tightened by a factor, as :func:`success_curve` does it."""
    best = threshold.best
    bound = best - scale * (best - threshold.bound) if threshold.higher_is_better else scale * threshold.bound
    return replace(threshold, bound=bound)


def smallest_scale(record: StudyEpisodeRecord, thresholds: Sequence[Threshold]) -> float:
    """The smallest factor on the thresholds at which an episode succeeds; infinite where none would do."""
    if record.failure is not None:
        return math.inf
    if record.done is not None and record.done.holds:
        return 0.0
    if not record.compared:
        return math.inf
    return needed_scale(
        {name: math.nan if value is None else value for name, value in record.metrics.items()}, thresholds
    )
