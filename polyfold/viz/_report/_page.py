"""The page: everything a report shows, in one file that fetches nothing."""

from __future__ import annotations

import hashlib
import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w

from polyfold.analysis import Results, table
from polyfold.analysis._columns import columns_of
from polyfold.analysis._notes import INTERVALS, REFERENCES, noise_floor
from polyfold.logs._disk.files import write_atomically
from polyfold.logs._records import MetricRecord
from polyfold.types import Threshold
from polyfold.viz._report._charts import percent_axis
from polyfold.viz._report._curves import scaled
from polyfold.viz._report._figures import (
    cause_names,
    cause_rows,
    cause_table,
    curve_panels,
    curve_table,
    headline,
    idle_references,
    legend,
    stage_names,
    success_panels,
    time_rows,
    time_table,
)
from polyfold.viz._report._gallery import LIMIT, gallery
from polyfold.viz._report._source import Source, open_source
from polyfold.viz._report._tabular import comparison_html, download, table_html

NO_BREAK = "\N{NO-BREAK SPACE}"
ASSETS = Path(__file__).parent


def write_report(folder: str | Path, out: str | Path | None = None, noise: Results | None = None) -> Path:
    """Write the report of a run directory; returns where it is.

    Args:
        folder: run directory of an evaluation, finished or not.
        out: the HTML file; by default ``report.html`` in the run directory.
        noise: see :func:`report_html`.

    Raises:
        ConfigError: if there is no run directory.
    """
    page = report_html(folder, noise)
    path = Path(out) if out is not None else Path(folder) / "report.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, page)
    return path


def report_html(folder: str | Path, noise: Results | None = None) -> str:
    """The report of a run directory as one self-contained HTML page.

    Args:
        folder: run directory of an evaluation, finished or not.
        noise: a study of what differs without meaning; it becomes a footnote to the comparisons.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    source = open_source(folder)
    # Sentences, names and reasons come from people and models: everything is escaped unless it is markup of ours.
    environment = Environment(
        loader=FileSystemLoader(ASSETS),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["figure"] = _shown
    floor = None if noise is None else noise_floor(noise)
    return environment.get_template("page.html").render(**_content(source), noise_floor=floor, **_assets())


def _shown(value: float, metric: MetricRecord) -> str:
    """A metric's value with its unit."""
    return f"{value:.{metric.digits}f} {metric.unit}".rstrip()


def _assets() -> dict[str, Any]:
    """Style and script, and a policy that lets a browser run these two and nothing else."""
    from markupsafe import Markup

    style = (ASSETS / "style.css").read_text("utf-8")
    script = (ASSETS / "filters.js").read_text("utf-8")
    policy = (
        f"default-src 'none'; img-src data:; style-src {_hash(style)}; script-src {_hash(script)}; "
        "base-uri 'none'; form-action 'none'"
    )
    return {"style": Markup(style), "script": Markup(script), "policy": Markup(policy)}


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _content(source: Source) -> dict[str, Any]:
    study = source.results.study
    first, *others = source.variants
    return {
        "study": study,
        "kinds": source.results.kinds(),
        "n": len(source.records),
        "expected": source.expected,
        "privileged": any(record.privileged for record in source.records),
        "goals": any(record.steps_wanted is None for record in source.records),
        "first": first,
        "run": source.results.run,
        "criteria": {name: _bounds(source, bounds) for name, bounds in source.results.run.criteria.items()},
        "bounded": [threshold.metric for threshold in source.own_criterion],
        "reference": REFERENCES[study.reference],
        "intervals": INTERVALS,
        "configuration": _toml(study.model_dump(mode="json")),
        **(_figures(source, others) if source.records else {}),
    }


def _figures(source: Source, others: list[str]) -> dict[str, Any]:
    results, first = source.results, source.variants[0]
    run = [variant for variant in others if results.of(variant)] if results.of(first) else []
    # Shares of success stand before the errors, so that a narrow window shows what matters most.
    columns = [column.heading for column in sorted(columns_of(results.run), key=lambda column: not column.is_success)]
    memory = [record.peak_memory_mb for record in source.records if record.peak_memory_mb is not None]
    return {
        "headline": headline(source) if results.of(first) else [],
        "success": success_panels(source),
        "tables": [
            ("By task type", table_html(table(results, columns, "type"), 2)),
            ("By task", table_html(table(results, columns, "task"), 2)),
        ],
        "by_kind": table_html(table(results, columns), 2),
        "comparison": comparison_html(results, first, run, columns) if run else "",
        "percent_axis": percent_axis(),
        "idle": idle_references(source),
        "curves": curve_panels(source),
        "half": _bounds(source, [scaled(threshold, 0.5) for threshold in source.own_criterion]),
        "causes": {"legend": legend(cause_names(source)), "rows": cause_rows(source)},
        "cause_table": table_html(cause_table(source), 2),
        "data": {
            "success": download(table(results, columns), "success"),
            "thresholds": download(curve_table(source), "thresholds"),
            "failures": download(cause_table(source), "failures"),
            "time": download(time_table(source), "time"),
        },
        "times": {"legend": legend(stage_names(source)), "rows": time_rows(source)},
        "time_table": table_html(time_table(source), 1),
        "memory": max(memory, default=None),
        "gallery": gallery(source),
        "gallery_limit": LIMIT,
    }


def _bounds(source: Source, thresholds: Sequence[Threshold]) -> list[str]:
    """Bounds in words, such as ``MPPE ≤ 30 mm``, that a line is not broken in."""
    return [_bound(threshold, source.results.run.metrics[threshold.metric]) for threshold in thresholds]


def _bound(threshold: Threshold, metric: MetricRecord) -> str:
    sign = "≥" if threshold.higher_is_better else "≤"
    return f"{metric.label} {sign} {threshold.bound:g} {metric.unit}".rstrip().replace(" ", NO_BREAK)


def _toml(settings: Mapping[str, Any]) -> str:
    """The study as the file that runs it again; as JSON if it was made in Python with values that TOML lacks."""
    try:
        return tomli_w.dumps({name: value for name, value in settings.items() if value is not None})
    except TypeError:
        return json.dumps(settings, indent=2)
