"""Columns of tables and plots: every metric of a run by its own name, and the share of success by each criterion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from polyfold import plugins
from polyfold.analysis._differences import difference, share_difference
from polyfold.analysis._intervals import Estimate, Labels, mean, share
from polyfold.errors import ConfigError, did_you_mean
from polyfold.logs import RunRecord, StudyEpisodeRecord
from polyfold.logs._records import MetricRecord


@dataclass(frozen=True)
class Column:
    """What a column averages over episodes.

    Attributes:
        heading: with the unit.
        names: what else it may be asked for by.
        digits: after the point.
        is_success: whether it is a share of success [%].
        value: of one episode; None where there was nothing to measure.
        most: the largest value that there can be; None if there is none.
    """

    heading: str
    names: tuple[str, ...]
    digits: int
    is_success: bool
    value: Callable[[StudyEpisodeRecord], float | None]
    most: float | None = None

    def over(self, records: Sequence[StudyEpisodeRecord]) -> Estimate:
        """The mean over episodes, with an interval for other sentences and garments."""
        values = [self.value(record) for record in records]
        if self.is_success:
            return share([None if value is None else value > 0 for value in values], *shared(records))
        found = mean(values, *shared(records))
        if not math.isfinite(found.high):
            return found  # an interval that says nothing is not made to look like one by a bound
        # A metric that is never negative, such as an error, has no negative mean.
        negative = any(value is not None and value < 0 for value in values)
        low = found.low if negative else max(found.low, 0.0)
        return replace(found, low=low, high=found.high if self.most is None else min(found.high, self.most))

    def between(self, ours: Sequence[StudyEpisodeRecord], theirs: Sequence[StudyEpisodeRecord]) -> Estimate:
        """Mean difference, ours − theirs, over the same episodes in the same order."""
        first, second = ([self.value(record) for record in records] for records in (ours, theirs))
        if self.is_success:
            pair = ([None if value is None else value > 0 for value in values] for values in (first, second))
            return share_difference(*pair, *shared(ours))
        found = difference(first, second, *shared(ours))
        if self.most is None or not math.isfinite(found.high - found.low):
            return found
        # Values from 0, as those with a bound are, to the largest: no two of them are farther apart.
        negative = any(value is not None and value < 0 for value in (*first, *second))
        widest = 2 * self.most if negative else self.most
        return replace(found, low=max(found.low, -widest), high=min(found.high, widest))


def shared(records: Sequence[StudyEpisodeRecord]) -> tuple[Labels, Labels]:
    """What episodes share with others: their sentences and their garments."""
    sentences = [(record.task or record.instruction, record.wording) for record in records]
    garments = [(record.garment.kind, record.garment.name, record.garment.seed) for record in records]
    return sentences, garments


def columns_of(run: RunRecord) -> list[Column]:
    """All columns of a run: success by its own criterion, then by the others, then its metrics."""
    metrics = [
        Column(metric.heading, (name, metric.label), metric.digits, False, _metric(name), _most(name, metric))
        for name, metric in run.metrics.items()
    ]
    own, *others = run.criteria
    success = [Column("success %", ("success", own, f"{own} %"), 1, True, _success(own))]
    success += [Column(f"{name} %", (name,), 1, True, _success(name)) for name in others]
    return [*success, *metrics]


def column_of(run: RunRecord, name: str) -> Column:
    """The column of a heading, metric or criterion. Raises ConfigError, naming the nearest, if there is none."""
    columns = columns_of(run)
    for column in columns:
        if name in (column.heading, *column.names):
            return column
    known = [known for column in columns for known in (column.heading, *column.names)]
    headings = ", ".join(column.heading for column in columns)
    raise ConfigError(f"there is no column {name!r}; {did_you_mean(name, known, f'choose from {headings}')}")


def _most(name: str, metric: MetricRecord) -> float | None:
    """The largest value of a metric; runs of before it was recorded are asked for by the installed metric."""
    if metric.most is None and name in plugins.names("metrics"):
        return getattr(plugins.component_class("metrics", name), "most", None)
    return metric.most


def _metric(name: str) -> Callable[[StudyEpisodeRecord], float | None]:
    return lambda record: record.metrics.get(name)


def _success(criterion: str) -> Callable[[StudyEpisodeRecord], float | None]:
    return lambda record: 100.0 * record.success[criterion]
