"""What the page's sections show, as rows and charts."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from polyfold.analysis import Estimate, Table, share
from polyfold.analysis._columns import Column, columns_of, shared
from polyfold.analysis._tables import Figure
from polyfold.evaluation._attribution import CAUSES
from polyfold.logs import StudyEpisodeRecord
from polyfold.viz._report._charts import Part, bar, curve_panel, dot
from polyfold.viz._report._curves import SCALES, success_curve
from polyfold.viz._report._source import Source

STAGES = ("reset", "subgoals", "grounding", "language", "policy", "execution")

COLOUR = {
    "reset": 6, "infrastructure": 6, "subgoals": 1, "subgoal": 1, "grounding": 2, "language": 3, "fold line": 3,
    "policy": 4, "execution": 0,
}  # fmt: skip
"""Colours of stages and causes: what belongs together looks alike in both charts."""

OTHER = 5


def legend(names: Iterable[str]) -> list[tuple[str, int]]:
    """Names of stages or causes with their colours."""
    return [(name, COLOUR.get(name, OTHER)) for name in names]


def _success(records: Sequence[StudyEpisodeRecord]) -> Estimate:
    return share([record.succeeded for record in records], *shared(records))


def headline(source: Source) -> list[dict[str, str]]:
    """The first variant's figures, success before metrics: what is read first."""
    records = source.of(source.variants[0])
    columns = sorted(columns_of(source.results.run), key=lambda column: not column.is_success)
    return [_figure(column, column.over(records)) for column in columns]


def _figure(column: Column, value: Estimate) -> dict[str, str]:
    figure = Figure(value, column.digits)
    label, _, unit = column.heading.removesuffix(" %").partition(" [")
    return {
        "label": label,
        "mean": figure.mean,
        "interval": " to ".join(figure.ends) if figure.has_interval else "",
        "unit": "%" if column.is_success else unit.rstrip("]"),
    }


def success_panels(source: Source) -> list[dict[str, Any]]:
    """Success of every variant, by kind: a dot with its interval."""
    panels = []
    for heading, kind in source.groups():
        rows = []
        for index, variant in enumerate(source.variants):
            records = source.of(variant, kind)
            if records:
                value = _success(records)
                rows.append({"variant": variant, "chart": dot(value, index), "mean": f"{value.mean:.1f}"})
        panels.append({"heading": heading, "n": _most(source, kind), "rows": rows})
    return panels


def _most(source: Source, kind: str | None) -> int:
    return max(len(source.of(variant, kind)) for variant in source.variants)


def curve_panels(source: Source) -> list[dict[str, Any]]:
    """Success over thresholds, by kind."""
    bands = len(source.variants) <= 4
    panels = []
    for heading, kind in source.groups():
        curves = [
            (variant, success_curve(source.of(variant, kind), source.own_criterion)) for variant in source.variants
        ]
        panels.append({"heading": heading, "n": _most(source, kind), "chart": curve_panel(heading, curves, bands)})
    return panels


def curve_table(source: Source) -> Table:
    """The numbers behind :func:`curve_panels`."""
    rows = []
    for heading, kind in source.groups():
        for variant in source.variants:
            curve = success_curve(source.of(variant, kind), source.own_criterion)
            for scale, mean, low, high in zip(SCALES, curve.shares, curve.low, curve.high, strict=True):
                value = Estimate(100.0 * mean, 100.0 * low, 100.0 * high, curve.n)
                rows.append([heading, variant, str(curve.n), f"{scale:g}", Figure(value)])
    return Table(["kind", "variant", "n", "thresholds ×", "success %"], rows)


def idle_references(source: Source) -> list[str]:
    """Tasks and garments of the episodes whose reference moved nothing: doing nothing is right there."""
    idle = [record for record in source.records if record.reference_idle]
    return [f"{record.task} on {record.garment.kind} {record.garment.seed}" for record in idle]


def _causes(records: Sequence[StudyEpisodeRecord]) -> Counter[str]:
    return Counter(record.cause or "unknown" for record in records if not record.succeeded)


def cause_names(source: Source) -> list[str]:
    """Causes that occur, in the order of the pipeline."""
    found = _causes(source.records)
    return [cause for cause in CAUSES if cause in found] + sorted(set(found) - set(CAUSES))


def cause_rows(source: Source) -> list[dict[str, Any]]:
    """What became of every variant's episodes: causes of failures, and successes as the quiet rest."""
    names, rows = cause_names(source), []
    for variant in source.variants:
        records = source.of(variant)
        if records:
            counts = _causes(records)
            parts = [_part(name, counts[name], f"{counts[name]}", f"{name}: {counts[name]}") for name in names]
            done = len(records) - counts.total()
            parts.append(Part(None, done, f"{done} succeeded", f"succeeded: {done}"))
            failed = f"{counts.total()} of {len(records)}"
            rows.append({"variant": variant, "chart": bar(parts, len(records)), "value": failed})
    return rows


def _part(name: str, value: float, label: str, title: str) -> Part:
    return Part(COLOUR.get(name, OTHER), value, label, title)


def cause_table(source: Source) -> Table:
    """Failures by variant, kind and cause."""
    names, rows = cause_names(source), []
    for variant in source.variants:
        for heading, kind in source.groups():
            records = source.of(variant, kind)
            if records:
                counts = _causes(records)
                cells = [f"{counts[name]}" if counts[name] else "·" for name in names]
                rows.append([variant, heading, str(len(records)), str(counts.total()), *cells])
    return Table(["variant", "kind", "n", "failed", *names], rows)


def stage_names(source: Source) -> list[str]:
    """Stages that took time, in the order of an episode."""
    found = {stage for record in source.records for stage in record.seconds}
    return [stage for stage in STAGES if stage in found] + sorted(found - set(STAGES))


def time_rows(source: Source) -> list[dict[str, Any]]:
    """Mean time of an episode by stage, all variants on one scale."""
    stages = stage_names(source)
    means = {variant: _stage_means(source.of(variant), stages) for variant in source.variants}
    longest = max((sum(mean.values()) for mean in means.values()), default=0.0)
    return [
        {
            "variant": variant,
            "chart": bar([_part(s, t, _seconds(t), f"{s}: {_seconds(t)}") for s, t in mean.items()], longest),
            "value": _seconds(sum(mean.values())),
        }
        for variant, mean in means.items()
        if mean
    ]


def _stage_means(records: Sequence[StudyEpisodeRecord], stages: Sequence[str]) -> Mapping[str, float]:
    if not records:
        return {}
    return {stage: statistics.fmean(record.seconds.get(stage, 0.0) for record in records) for stage in stages}


def time_table(source: Source) -> Table:
    """Mean seconds by stage, and the mean, median and 95th percentile of whole episodes."""
    stages, rows = stage_names(source), []
    for variant in source.variants:
        records = source.of(variant)
        if not records:
            continue
        totals = sorted(sum(record.seconds.values()) for record in records)
        late = totals[min(len(totals) - 1, math.ceil(0.95 * len(totals)) - 1)]
        means = _stage_means(records, stages)
        cells = [f"{value:.3f}" if value else "·" for value in means.values()]
        whole = [f"{value:.3f}" for value in (sum(means.values()), statistics.median(totals), late)]
        rows.append([variant, str(len(records)), *cells, *whole])
    return Table(["variant", "n", *stages, "mean [s]", "median [s]", "95th pct. [s]"], rows)


def _seconds(value: float) -> str:
    if value >= 100:
        return f"{value:.0f} s"
    return f"{value:.1f} s" if value >= 9.95 else f"{value:.2f} s" if value >= 0.0995 else f"{1000 * value:.0f} ms"
