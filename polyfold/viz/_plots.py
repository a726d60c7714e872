"""Results as a picture: variants side by side, with intervals."""

from __future__ import annotations

import math
from typing import Any

from polyfold.analysis import Results
from polyfold.analysis._columns import column_of
from polyfold.types._views import makes

PALETTE = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8c8c8c")
"""Colours that colour-blind readers can tell apart (Okabe and Ito)."""


@makes(Results, "bars")
def bars(results: Results, column: str = "success %") -> Any:
    """One group of bars per garment kind, one bar per variant, 95 % intervals.

    Args:
        results: of a study.
        column: heading of a column of :func:`polyfold.table`, a metric's name or a criterion's.

    Returns:
        A matplotlib figure.
    """
    from matplotlib.figure import Figure

    chosen = column_of(results.run, column)
    kinds, variants = results.kinds(), list(results.study.variants)
    figure = Figure(figsize=(2.0 + 1.6 * len(kinds), 3.2), layout="constrained")
    axes = figure.subplots()
    width = 0.8 / len(variants)
    for number, variant in enumerate(variants):
        found = [chosen.over(results.of(variant, kind)) for kind in kinds]
        at = [place + (number - (len(variants) - 1) / 2) * width for place in range(len(kinds))]
        means = [value.mean for value in found]
        spans = [[error_bar(v.mean - v.low) for v in found], [error_bar(v.high - v.mean) for v in found]]
        colour = PALETTE[number % len(PALETTE)]
        axes.bar(at, means, 0.92 * width, yerr=spans, label=variant, color=colour, capsize=2, error_kw={"lw": 1})
    axes.set_xticks(range(len(kinds)), kinds)
    axes.set_ylabel(chosen.heading)
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside upper center", ncols=min(len(variants), 3), frameon=False, fontsize=8)
    return figure


def error_bar(length: float) -> float:
    """Half an error bar; none where a single episode says nothing of others."""
    return max(0.0, length) if math.isfinite(length) else 0.0
