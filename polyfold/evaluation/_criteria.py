"""Success criteria: bounds on metrics that all must hold against one and the same reference.

The paper names MPPE, mIoU and a success rate over thresholds that it does not publish (Sec. V-C). Criteria are
components like any other (:class:`polyfold.plugins.interfaces.SuccessCriterion`); a study names those that it counts,
its own first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from polyfold import plugins
from polyfold.errors import ConfigError, did_you_mean
from polyfold.types import Threshold


def criteria(names: Sequence[str]) -> dict[str, tuple[Threshold, ...]]:
    """The bounds of registered criteria, by name.

    Raises:
        PluginError: if one is not registered.
        ConfigError: if one bounds a metric that is not.
    """
    found = {name: tuple(plugins.component_class("criteria", name).thresholds) for name in names}
    metrics = plugins.names("metrics")
    for name, thresholds in found.items():
        for threshold in thresholds:
            if threshold.metric not in metrics:
                raise ConfigError(
                    f"the criterion {name!r} bounds the metric {threshold.metric!r}, which is not installed; "
                    f"{did_you_mean(threshold.metric, metrics)}"
                )
    return found


def succeeded(values: Mapping[str, float], thresholds: Sequence[Threshold]) -> bool:
    """Whether metric values meet every bound; where there is nothing to measure at all, nothing succeeded."""
    return _measured(values, thresholds) and all(threshold.holds(values[threshold.metric]) for threshold in thresholds)


def needed_scale(values: Mapping[str, float], thresholds: Sequence[Threshold]) -> float:
    """The factor on what the bounds allow at which metric values just meet them all: 0 is perfect, infinite never."""
    if not _measured(values, thresholds):
        return math.inf
    return max(threshold.share(values[threshold.metric]) for threshold in thresholds)


def _measured(values: Mapping[str, float], thresholds: Sequence[Threshold]) -> bool:
    """Whether there was anything to measure: the moved part, say, is not where the reference moves nothing."""
    return not all(math.isnan(values[threshold.metric]) for threshold in thresholds)
