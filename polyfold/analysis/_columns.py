"""Columns of tables and plots: every metric of a run by its own name, and the share of success by each criterion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from polyfold.errors import ConfigError, did_you_mean
from polyfold.logs import RunRecord, StudyEpisodeRecord


@dataclass(frozen=True)
class Column:
    """What a column averages over episodes.

    Attributes:
        heading: with the unit.
        names: what else it may be asked for by.
        digits: after the point.
        is_success: whether it is a share of success [%].
        value: of one episode; None where there was nothing to measure.
    """

    heading: str
    names: tuple[str, ...]
    digits: int
    is_success: bool
    value: Callable[[StudyEpisodeRecord], float | None]


def columns_of(run: RunRecord) -> list[Column]:
    """All columns of a run: its metrics, then success by its own criterion, then by the others."""
    metrics = [
        Column(metric.heading, (name, metric.label), metric.digits, False, _metric(name))
        for name, metric in run.metrics.items()
    ]
    own, *others = run.criteria
    success = [Column("success %", ("success", own, f"{own} %"), 1, True, _success(own))]
    success += [Column(f"{name} %", (name,), 1, True, _success(name)) for name in others]
    return [*metrics, *success]


def column_of(run: RunRecord, name: str) -> Column:
    """The column of a heading, metric or criterion. Raises ConfigError, naming the nearest, if there is none."""
    columns = columns_of(run)
    for column in columns:
        if name in (column.heading, *column.names):
            return column
    known = [known for column in columns for known in (column.heading, *column.names)]
    headings = ", ".join(column.heading for column in columns)
    raise ConfigError(f"there is no column {name!r}; {did_you_mean(name, known, f'choose from {headings}')}")


def _metric(name: str) -> Callable[[StudyEpisodeRecord], float | None]:
    return lambda record: record.metrics.get(name)


def _success(criterion: str) -> Callable[[StudyEpisodeRecord], float | None]:
    return lambda record: 100.0 * record.success[criterion]
