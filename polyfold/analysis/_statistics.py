"""Means with bootstrap intervals, and paired differences on the same episodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 2000


@dataclass(frozen=True)
class Estimate:
    """A mean with its 95 % bootstrap interval; NaN without values.

    Attributes:
        mean, low, high: in the unit of the values.
        n: number of values.
    """

    mean: float
    low: float
    high: float
    n: int


def estimate(values: Sequence[float | None]) -> Estimate:
    """Mean and interval of values; None and NaN (nothing to measure) are left out."""
    return ratio(values, [1.0] * len(values))


def ratio(totals: Sequence[float | None], counts: Sequence[float]) -> Estimate:
    """Sum of totals over sum of counts, such as seconds over calls, with an interval from whole episodes.

    Args:
        totals: one per episode; None and NaN (nothing to measure) are left out.
        counts: what each is the total of; episodes with 0 are left out.
    """
    pairs = np.array([(a, b) for a, b in zip(totals, counts, strict=True) if a is not None and b], float).reshape(-1, 2)
    pairs = pairs[np.isfinite(pairs).all(axis=1)]
    if len(pairs) == 0:
        return Estimate(float("nan"), float("nan"), float("nan"), 0)
    # A fixed seed, and an order of its own: the same episodes give the same interval, in whatever order they ran.
    pairs = pairs[np.lexsort(pairs.T)]
    draws = np.random.default_rng(0).integers(0, len(pairs), (RESAMPLES, len(pairs)))
    sums = pairs[draws].sum(axis=1)
    low, high = np.percentile(sums[:, 0] / sums[:, 1], [2.5, 97.5])
    total, count = pairs.sum(axis=0)
    return Estimate(float(total / count), float(low), float(high), len(pairs))


def paired(ours: Sequence[float | None], theirs: Sequence[float | None]) -> Estimate:
    """Mean difference ours − theirs over episodes that both have a value for, in the same order."""
    both = [(a, b) for a, b in zip(ours, theirs, strict=True) if a is not None and b is not None]
    return estimate([a - b for a, b in both])
