"""Measured folds as a table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

OURS = "polyfold xpbd"

COLUMNS = (
    "fold",
    "engine",
    "settings of",
    "particles",
    "n",
    "CPU s per fold",
    "times ours",
    "IoU, mean (worst)",
    "error of moved part",
    "strain p99",
    "piercing edges",
)


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown of rows as ``measure`` in ``__main__`` gives them, grouped by fold and engine in order of appearance."""
    groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        groups.setdefault((row["fold"], row["engine"]), []).append(row)
    ours = {(row["fold"], row["seed"]): row["seconds"] for row in rows if row["engine"] == OURS}
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---" * len(COLUMNS) + "|"]
    for (fold, engine), group in groups.items():
        cells = [fold, engine, group[0]["settings"], _range([row["particles"] for row in group], "{:.0f}")]
        lines.append("| " + " | ".join(cells + _measured(group, ours)) + " |")
    return "\n".join(lines)


def _measured(group: list[dict[str, Any]], ours: dict[tuple[str, int], float]) -> list[str]:
    folded = [row for row in group if row["outcome"] == "folded"]
    others = [row for row in group if row["outcome"] != "folded"]
    words = sorted({row["outcome"] for row in others})
    remarks = [f"{word} ({sum(row['outcome'] == word for row in others)} of {len(group)})" for word in words]
    if not folded:
        return [str(len(group)), "; ".join(remarks), "-", "-", "-", "-", "-"]
    seconds = [row["seconds"] for row in folded]
    # Against our time on the same garments: a mean of ratios would weigh garments by their size.
    times = sum(seconds) / max(sum(ours.get((row["fold"], row["seed"]), np.nan) for row in folded), 1e-9)
    overlaps = [row["overlap"] for row in folded]
    return [
        str(len(group)),
        "; ".join([_spread(seconds), *remarks]),
        f"{times:.0f}",
        f"{np.mean(overlaps):.3f} ({min(overlaps):.3f})",
        f"{1000 * _mean(folded, 'error'):.1f} mm",
        f"{100 * _mean(folded, 'strain'):.1f} %",
        f"{100 * _mean(folded, 'piercing'):.2f} %",
    ]


def _mean(rows: Iterable[dict[str, Any]], name: str) -> float:
    return float(np.mean([row[name] for row in rows]))


def _spread(values: Sequence[float]) -> str:
    digits = 2 if np.mean(values) < 10 else 0
    return f"{np.mean(values):.{digits}f} [{min(values):.{digits}f}, {max(values):.{digits}f}]"


def _range(values: Sequence[float], form: str) -> str:
    low, high = form.format(min(values)), form.format(max(values))
    return low if low == high else f"{low}-{high}"
