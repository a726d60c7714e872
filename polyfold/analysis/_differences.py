"""Paired differences between variants on the same episodes: how large, how sure, and for how many comparisons at once.

Differences of shares have the interval of Bonett and Price (2012, doi 10.3102/1076998611411915), whose variance holds
where few pairs differ, with as many pairs as independent ones would say as much; their test is McNemar's, exact. Other
differences have the interval of a mean, and their test flips the signs of whole clusters. Holm's procedure says which
of a table's differences remain when all are looked at.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from polyfold.analysis._intervals import Estimate, Floats, Labels, codes_of, mean, quantile_of, spread

FEWEST, MOST_TRIED, FLIPS = 6, 12, 4999
"""Clusters that a test needs; up to how many all their signs are tried; how many random ones, if there are more."""


def difference(ours: Sequence[float | None], theirs: Sequence[float | None], *clusters: Labels) -> Estimate:
    """Mean of ours − theirs over episodes that both have a value for, in the same order; see :func:`mean`."""
    gaps = _numbers(ours) - _numbers(theirs)
    found = mean(gaps.tolist(), *clusters)
    if found.n == 0:
        return found
    known = np.isfinite(gaps)
    p = _flipped(gaps[known], codes_of(clusters, known))
    return Estimate(found.mean, found.low, found.high, found.n, p)


def _numbers(values: Sequence[float | None]) -> Floats:
    return np.array([math.nan if value is None else value for value in values], float)


def share_difference(ours: Sequence[bool | None], theirs: Sequence[bool | None], *clusters: Labels) -> Estimate:
    """Difference of shares, ours − theirs [percentage points], over episodes that both tell something of."""
    known = np.array([a is not None and b is not None for a, b in zip(ours, theirs, strict=True)], bool)
    n = int(known.sum())
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    gaps = np.array([float(bool(a)) - float(bool(b)) for a, b in zip(ours, theirs, strict=True)])[known]
    won, lost = int((gaps > 0).sum()), int((gaps < 0).sum())
    codes = codes_of(clusters, known)
    found = spread((gaps - gaps.mean()) / n, *codes)
    alone = float(gaps.var()) / n
    worth, quantile = float(n), quantile_of(math.inf)
    if found.variance > alone > 0:
        worth, quantile = n * alone / found.variance, quantile_of(found.freedom)
    better, worse = (won / n * worth + 1) / (worth + 2), (lost / n * worth + 1) / (worth + 2)
    middle, half = better - worse, quantile * math.sqrt((better + worse - (better - worse) ** 2) / (worth + 2))
    low, high = max(-1.0, middle - half), min(1.0, middle + half)
    p = max(mcnemar(won, lost), _flipped(gaps, codes) if codes else 0.0)
    return Estimate(100 * float(gaps.mean()), 100 * low, 100 * high, n, p)


def mcnemar(won: int, lost: int) -> float:
    """How probable it is that pairs which differ are divided at least as unevenly as this if neither is better."""
    from scipy.stats import binomtest

    return 1.0 if won + lost == 0 else float(binomtest(won, won + lost).pvalue)


def holm(values: Sequence[float | None]) -> list[float | None]:
    """P values adjusted for there being so many (Holm 1979); None stays None."""
    known = sorted((p, index) for index, p in enumerate(values) if p is not None)
    adjusted: list[float | None] = [None] * len(values)
    least = 0.0
    for rank, (p, index) in enumerate(known):
        least = max(least, min(1.0, (len(known) - rank) * p))
        adjusted[index] = least
    return adjusted


def _flipped(gaps: Floats, codes: Sequence[NDArray[np.int64]]) -> float:
    """How probable a mean at least as far from 0 is if each cluster's differences could as well have the other sign.

    Clusters are of the kind of which there are fewest, but six, with which p can be below 5 %; else the most numerous.
    """
    sums = _sums(gaps, codes)
    if not sums.any():
        return 1.0
    reached = abs(float(sums.sum())) * (1 - 1e-12)
    if len(sums) <= MOST_TRIED:
        signs = 1.0 - 2.0 * ((np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums))) & 1)
        return float((np.abs(signs @ sums) >= reached).mean())
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (FLIPS, len(sums)))
    return (1 + int((np.abs(signs @ np.sort(sums)) >= reached).sum())) / (1 + FLIPS)


def _sums(gaps: Floats, codes: Sequence[NDArray[np.int64]]) -> Floats:
    kinds: list[Floats] = sorted((np.bincount(code, gaps).astype(float) for code in codes), key=len)
    enough = [sums for sums in kinds if len(sums) >= FEWEST]
    return [*enough[:1], *kinds[-1:], gaps][0]
