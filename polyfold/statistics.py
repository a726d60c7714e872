"""Means with bootstrap intervals, and paired differences on the same episodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

__all__ = ["Estimate", "estimate", "paired"]

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
    found = np.array([value for value in values if value is not None], float)
    found = found[np.isfinite(found)]
    if len(found) == 0:
        return Estimate(float("nan"), float("nan"), float("nan"), 0)
    # A fixed seed: the same results give the same table.
    draws = np.random.default_rng(0).integers(0, len(found), (RESAMPLES, len(found)))
    low, high = np.percentile(found[draws].mean(axis=1), [2.5, 97.5])
    return Estimate(float(found.mean()), float(low), float(high), len(found))


def paired(ours: Sequence[float | None], theirs: Sequence[float | None]) -> Estimate:
    """Mean difference ours − theirs over episodes that both have a value for, in the same order."""
    both = [(a, b) for a, b in zip(ours, theirs, strict=True) if a is not None and b is not None]
    return estimate([a - b for a, b in both])
