"""An episode's end beside its references: metrics, the nearest reference, success."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from polyfold.evaluation._criteria import needed_scale, succeeded
from polyfold.evaluation._references import Reference
from polyfold.plugins.interfaces import Metric
from polyfold.types import Outcome, Threshold


@dataclass(frozen=True, eq=False)
class Comparison:
    """An episode's end beside its references.

    Attributes:
        values: metrics against the nearest reference, NaN without one.
        nearest: the reference that comes nearest to success by the first criterion; None without any.
        success: by criterion, whether all bounds hold against one and the same reference.
    """

    values: Mapping[str, float]
    nearest: Reference | None
    success: Mapping[str, bool]


def compare_end(
    end: Outcome,
    references: Sequence[Reference],
    metrics: Mapping[str, Metric],
    criteria: Mapping[str, Sequence[Threshold]],
) -> Comparison:
    """Compare an end with each of its references; any of them may be met.

    Args:
        end: how the episode began and ended.
        references: what counts as right; may be empty.
        metrics: by name.
        criteria: bounds by name, the one that decides which reference is nearest first.

    Raises:
        PluginError: if a metric fails, naming it.
    """
    if not references:
        return Comparison(dict.fromkeys(metrics, math.nan), None, dict.fromkeys(criteria, False))
    scores = [
        {name: metric.score(end, [reference.outcome]) for name, metric in metrics.items()} for reference in references
    ]
    first = next(iter(criteria.values()))
    nearest = min(range(len(scores)), key=lambda index: needed_scale(scores[index], first))
    success = {name: any(succeeded(values, bounds) for values in scores) for name, bounds in criteria.items()}
    return Comparison(scores[nearest], references[nearest], success)
