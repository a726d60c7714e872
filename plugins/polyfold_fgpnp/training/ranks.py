"""Rank correlation, which tells whether a prediction orders picks as they came out."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def rank_correlation(predicted: ArrayLike, true: ArrayLike) -> float:
    """Spearman's coefficient of values, shape (N,) each; NaN for fewer than three or if either is constant."""
    from scipy.stats import rankdata

    predicted, true = np.asarray(predicted, float), np.asarray(true, float)
    if len(predicted) < 3 or np.ptp(predicted) == 0 or np.ptp(true) == 0:
        return float("nan")
    return float(np.corrcoef(rankdata(predicted), rankdata(true))[0, 1])
