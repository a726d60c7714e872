"""Means and shares with 95 % intervals that hold for other sentences and other garments.

Episodes that share a sentence or a garment are not independent: 280 episodes of 70 sentences on 4 garments say less
than 280 of both. So the variance of a mean is that of its clusters, crossed (Cameron, Gelbach and Miller 2011,
doi 10.1198/jbes.2010.07136), with Satterthwaite's degrees of freedom, and the interval is studentised with a correction
for skewness (Hall 1992, doi 10.1111/j.2517-6161.1992.tb01860.x). Shares have Wilson's interval with as many episodes as
independent ones would say as much (doi 10.1080/01621459.1927.10502953). Nothing is drawn at random.

How often these intervals hold is measured by ``python -m experiments.benchmarks.coverage``.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Labels = Sequence[Hashable]
"""What each episode shares with others: episodes with equal labels form a cluster."""

LEVEL, NORMAL = 0.95, 1.959964
"""Of the intervals, and the two-sided quantile of the normal distribution for it."""
SKEWEST = 1.5
"""Skewness of a mean beyond which few clusters say nothing certain of it."""


@dataclass(frozen=True)
class Estimate:
    """A mean with its 95 % interval; NaN without values.

    Attributes:
        mean, low, high: in the unit of the values; the interval of a single one is infinite.
        n: number of values.
        p: for differences, how probable one at least as large is if there is none; None otherwise.
    """

    mean: float
    low: float
    high: float
    n: int
    p: float | None = None


@dataclass(frozen=True)
class Spread:
    """What a mean may be off by.

    Attributes:
        variance: of the mean.
        freedom: degrees of freedom of the variance.
        skewness: of the mean.
    """

    variance: float
    freedom: float
    skewness: float


def mean(values: Sequence[float | None], *clusters: Labels) -> Estimate:
    """Mean and interval of values; None and NaN (nothing to measure) are left out.

    Args:
        values: one per episode.
        clusters: what they share, such as sentences and garments: a label per episode each, at most two kinds. Without
            any, all are independent; an interval over one garment alone holds for that garment.
    """
    return ratio(values, [1.0] * len(values), *clusters)


def ratio(totals: Sequence[float | None], counts: Sequence[float], *clusters: Labels) -> Estimate:
    """Sum of totals over sum of counts, such as seconds over calls.

    Args:
        totals: one per episode; None and NaN (nothing to measure) are left out.
        counts: what each is the total of; episodes with 0 are left out.
        clusters: as in :func:`mean`.
    """
    numerators, denominators, known = _known(totals, counts)
    if len(numerators) == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    count = _total(denominators)
    value = _total(numerators) / count
    found = spread((numerators - value * denominators) / count, *codes_of(clusters, known))
    low, high = _studentised(value, found)
    return Estimate(value, low, high, len(numerators))


def share(values: Sequence[bool | None], *clusters: Labels) -> Estimate:
    """Share of what is true [%]; None (nothing to tell) is left out. Arguments as for :func:`mean`."""
    return share_of(values, [1.0] * len(values), *clusters)


def share_of(totals: Sequence[float | None], counts: Sequence[float], *clusters: Labels) -> Estimate:
    """Share of many things in an episode [%], such as valid answers of all; arguments as for :func:`ratio`."""
    numerators, denominators, known = _known(totals, counts)
    n = len(numerators)
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    count = _total(denominators)
    p = min(1.0, _total(numerators) / count)
    found = spread((numerators - p * denominators) / count, *codes_of(clusters, known))
    worth, quantile = float(n), quantile_of(math.inf)
    if 0 < found.variance < math.inf:
        # Clusters can make episodes say less, and few of them leave that uncertain; nothing makes them say more.
        worth = min(count, p * (1 - p) / found.variance)
        quantile = quantile_of(found.freedom)
    low, high = wilson(p, worth, quantile)
    return Estimate(100 * p, 100 * low, 100 * high, n)


def wilson(p: float, n: float, quantile: float = NORMAL) -> tuple[float, float]:
    """Wilson's interval of a share ``p``, 0 to 1, seen in ``n`` (maybe effective) independent episodes."""
    if n == 0:
        return 0.0, 1.0
    square = quantile * quantile
    middle = (p * n + square / 2) / (n + square)
    half = quantile / (n + square) * math.sqrt(max(0.0, n * p * (1 - p)) + square / 4)
    return max(0.0, middle - half), min(1.0, middle + half)


def spread(deviations: Floats, *codes: NDArray[np.int64]) -> Spread:
    """What a mean may be off by, from the part that each episode has in it, shape (n,), which sum to 0.

    Args:
        deviations: of every episode from the mean, divided by n.
        codes: the clusters that it belongs to, numbered; at most two kinds.
    """
    n = len(deviations)
    # One sentence, or one garment, says nothing of others: the interval is of that one.
    codes = tuple(code for code in codes if len(code) and code.min() < code.max())
    cells = np.unique(np.stack(codes), axis=1, return_inverse=True)[1] if len(codes) > 1 else np.arange(n)
    within = _of_clusters(deviations, cells)
    # A kind of cluster whose members are no more alike than others adds nothing.
    alike = [one for one in (_of_clusters(deviations, code) for code in codes) if one.variance > within.variance]
    if not alike:
        return within
    variance = within.variance + sum(one.variance - within.variance for one in alike)
    freedom = variance**2 / sum(one.variance**2 / one.freedom for one in alike)
    third = _third(within) + sum(_third(one) - _third(within) for one in alike)
    return Spread(variance, min(freedom, n - 1.0), third / variance**1.5)


def quantile_of(freedom: float) -> float:
    """Student's two-sided 95 % quantile."""
    from scipy.special import stdtrit

    return NORMAL if math.isinf(freedom) else float(stdtrit(max(freedom, 1.0), (1 + LEVEL) / 2))


def _third(found: Spread) -> float:
    return found.skewness * found.variance**1.5


def _of_clusters(deviations: Floats, code: NDArray[np.int64]) -> Spread:
    order = np.lexsort((deviations, code))
    sums = np.bincount(code[order], deviations[order]).astype(np.float64)
    count = len(sums)
    if count < 2:
        return Spread(math.inf, 1.0, 0.0)
    variance = _total(sums**2) * count / (count - 1)
    third = _total(sums**3) * count**2 / ((count - 1) * (count - 2)) if count > 2 else 0.0
    return Spread(variance, count - 1.0, third / variance**1.5 if variance > 0 else 0.0)


def _studentised(value: float, found: Spread) -> tuple[float, float]:
    """The interval by Hall's monotone transformation, which takes out the skewness."""
    if not math.isfinite(found.variance):
        return -math.inf, math.inf
    quantile, skew = quantile_of(found.freedom), min(SKEWEST, max(-SKEWEST, found.skewness))

    def back(y: float) -> float:
        return y if abs(skew) < 1e-6 else 3 / skew * (math.cbrt(1 + skew * (y - skew / 6)) - 1)

    error = math.sqrt(found.variance)
    return value - error * back(quantile), value - error * back(-quantile)


def _total(values: Floats) -> float:
    """The sum, to the last bit the same in whatever order episodes ran."""
    return float(np.sort(values).sum())


def _known(totals: Sequence[float | None], counts: Sequence[float]) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Totals and counts of the episodes that have both, and which these are."""
    known = np.array([a is not None and math.isfinite(a) and b > 0 for a, b in zip(totals, counts, strict=True)], bool)
    numerators = np.array([math.nan if a is None else a for a in totals], float)
    return numerators[known], np.asarray(counts, float)[known], known


def codes_of(clusters: Sequence[Labels], known: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Labels as numbers, of the episodes that are known."""
    found = []
    for labels in clusters:
        numbers: dict[Hashable, int] = {}
        found.append(
            np.array(
                [numbers.setdefault(label, len(numbers)) for label, keep in zip(labels, known, strict=True) if keep],
                np.int64,
            )
        )
    return found
