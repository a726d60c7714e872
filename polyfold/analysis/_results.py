"""What a study found: its records, and how they are selected, tabulated and compared."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polyfold.analysis._statistics import estimate, paired
from polyfold.analysis._tables import Table, shown
from polyfold.errors import ConfigError
from polyfold.logs import read_episodes
from polyfold.studies import Study
from polyfold.types._views import view_of

Record = Mapping[str, Any]

KINDS = ("square", "rectangle", "tshirt", "pants")


@dataclass(frozen=True, eq=False)
class Results:
    """The finished episodes of a study.

    Attributes:
        study: what was run.
        records: one per episode, as :func:`polyfold.evaluation.evaluate_cell` makes them.
    """

    study: Study
    records: Sequence[Record]

    def of(self, variant: str, kind: str | None = None) -> list[Record]:
        """Records of a variant, of one garment kind or of all."""
        return [r for r in self.records if r["variant"] == variant and (kind is None or r["garment"] == kind)]

    def kinds(self) -> list[str]:
        """Garment kinds that occur, the paper's four first."""
        found = {record["garment"] for record in self.records}
        return [kind for kind in KINDS if kind in found] + sorted(found - set(KINDS))

    def of_length(self, steps: str) -> Results:
        """Only the episodes whose task has one fold (``single``) or several (``multi``)."""
        wanted = {"single": lambda count: count == 1, "multi": lambda count: count > 1}[steps]
        kept = [r for r in self.records if r["steps_wanted"] is not None and wanted(r["steps_wanted"])]
        return Results(self.study, kept)

    def plot(self, column: str = "success %") -> Any:
        """Bars per garment kind and variant with intervals, as a matplotlib figure."""
        return view_of(self, "bars", column)

    def _repr_html_(self) -> str:
        return table(self).html()


def open_results(out: str | Path) -> Results:
    """Read a run directory, finished or not. Raises ConfigError if there is none."""
    description = Path(out) / "run.json"
    if not description.exists():
        raise ConfigError(f"{out} is no run directory (it has no run.json); give the --out of an evaluation")
    config = json.loads(description.read_text("utf-8"))["config"]
    if "study" not in config:
        raise ConfigError(f"{out} holds no study; give the --out of an evaluation")
    return Results(Study(**config["study"]), read_episodes(out))


def compared(record: Record) -> bool:
    """Whether there was anything to compare an episode with: goals that accept no task have metrics of None."""
    return any(value is not None for value in record["metrics"].values())


COLUMNS: dict[str, Callable[[Record], float | None]] = {
    "MPPE [mm]": lambda record: record["metrics"]["mppe"],
    "mIoU": lambda record: record["metrics"]["miou"],
    "moved part [mm]": lambda record: record["metrics"]["moved-part"],
    "success %": lambda record: 100.0 * record["success"]["polyfold"],
    "strict %": lambda record: 100.0 * record["success"]["strict"],
}
"""Columns of the tables: what is averaged."""

REFERENCES = {
    "oracle": "the oracle from the same start",
    "ideal": "the flat garment folded geometrically along the task's lines",
}
"""What results are compared with, in words."""

DIGITS = {"mIoU": 3}
"""Digits after the point, where they are not one."""


def table(
    results: Results, columns: Sequence[str] = tuple(COLUMNS), groups: str = "kind", noise: Results | None = None
) -> Table:
    """Variants by garment kind (``kind``), task type (``type``), ``task``, ``split``, ``step``, or all (``none``).

    Cells are means with 95 % bootstrap intervals; n is the number of episodes.

    Args:
        results: what to tabulate.
        columns: of :data:`COLUMNS`, or names of metrics.
        groups: what makes a row; ``step`` gives the mean particle error after each of the episode's own folds.
        noise: a study of what differs without meaning; it becomes a footnote, see :func:`noise_floor`.
    """
    if groups == "step":
        return _by_step(results)
    keys = {"kind": "garment", "type": "type", "task": "task", "split": "split", "none": None}
    if groups not in keys:
        raise ConfigError(f"can't group by {groups!r}; choose one of {', '.join(keys)}, step")
    rows = []
    for variant in results.study.variants:
        for group, records in _grouped(results, variant, keys[groups]):
            cells = [_mean(column, records) for column in columns]
            rows.append([_marked(variant, records), group, str(len(records)), *cells])
    rows += _published(results, columns, dict.fromkeys(row[1] for row in rows))
    note = f"{results.study.name}: mean [95 % bootstrap interval]; reference: {REFERENCES[results.study.reference]}."
    if any(record.get("steps_wanted", 0) is None for record in results.records):
        note += " Goals: the nearest task that each accepts; success includes those that are done by their own bounds."
    if any(record["privileged"] for record in results.records):
        note += " * privileged: sees more than the camera."
    if noise is not None:
        note += " " + noise_floor(noise)
    return Table(["variant", groups if groups != "none" else "", "n", *columns], rows, note)


def noise_floor(noise: Results) -> str:
    """How far results differ that differ in nothing that matters, as a sentence.

    Args:
        noise: a study of the oracle with its particles, contacts and constraints in other orders.
    """
    columns = ", ".join(f"{column} {_mean(column, noise.records)}" for column in COLUMNS)
    count = len(noise.records)
    return f"Noise floor, the oracle repeated with particles and contacts in another order (n={count}): {columns}."


def _by_step(results: Results) -> Table:
    most = max((len(record["step_errors_mm"]) for record in results.records), default=0)
    rows = []
    for variant in results.study.variants:
        for kind, records in _grouped(results, variant, "garment"):
            errors = [record["step_errors_mm"] for record in records]
            after = [[found[step] for found in errors if len(found) > step] for step in range(most)]
            cells = [f"{shown(estimate(values))} (n={len(values)})" if values else "–" for values in after]
            rows.append([_marked(variant, records), kind, *cells])
    note = f"{results.study.name}: mean particle error [mm] after each fold of the episode's own."
    return Table(["variant", "kind", *(f"step {step + 1}" for step in range(most))], rows, note)


def _published(results: Results, columns: Sequence[str], groups: Iterable[str]) -> list[list[str]]:
    """Rows of what others published, which is success alone."""
    return [
        [label, kind, "–", *(f"{figures[kind]:.1f}" if column == "success %" else "–" for column in columns)]
        for label, figures in results.study.published.items()
        for kind in groups
        if kind in figures
    ]


def _mean(column: str, records: Sequence[Record]) -> str:
    return shown(estimate([_value(column, record) for record in records]), DIGITS.get(column, 1))


def _value(column: str, record: Record) -> float | None:
    if column in COLUMNS:
        return COLUMNS[column](record)
    if column in record["metrics"]:
        return record["metrics"][column]
    raise ConfigError(f"there is no column {column!r}; choose from {', '.join([*COLUMNS, *record['metrics']])}")


def _marked(variant: str, records: Sequence[Record]) -> str:
    return f"{variant} *" if any(record["privileged"] for record in records) else variant


def _grouped(results: Results, variant: str, key: str | None) -> list[tuple[str, list[Record]]]:
    if key == "garment":
        found = [(kind, results.of(variant, kind)) for kind in results.kinds()]
        found.append(("all", results.of(variant)))
    elif key is None:
        found = [("all", results.of(variant))]
    else:
        names = dict.fromkeys(record.get(key) for record in results.records)
        found = [(name or "–", [r for r in results.of(variant) if r.get(key) == name]) for name in names]
        found.append(("all", results.of(variant)))
    return [(name, records) for name, records in found if records]


def compare(results: Results, variant: str, baseline: str) -> Table:
    """Paired differences between two variants on the same tasks, garments and wordings."""
    for name in (variant, baseline):
        if name not in results.study.variants:
            raise ConfigError(f"there is no variant {name!r}; choose from {', '.join(results.study.variants)}")
    ours, theirs = (_by_episode(results.of(name)) for name in (variant, baseline))
    shared = [key for key in ours if key in theirs]
    rows = []
    for kind in [*results.kinds(), "all"]:
        keys = [key for key in shared if kind in ("all", ours[key]["garment"])]
        if keys:
            pair = [ours[key] for key in keys], [theirs[key] for key in keys]
            rows.append([kind, str(len(keys)), *(_difference(column, *pair) for column in COLUMNS)])
    note = f"{variant} − {baseline}, the same episodes; mean [95 % bootstrap interval]."
    return Table(["kind", "n", *COLUMNS], rows, note)


def _difference(column: str, ours: Sequence[Record], theirs: Sequence[Record]) -> str:
    value = COLUMNS[column]
    found = paired([value(record) for record in ours], [value(record) for record in theirs])
    return shown(found, DIGITS.get(column, 1), signed=True)


def _by_episode(records: Sequence[Record]) -> dict[tuple[Any, ...], Record]:
    return {(record["task"], record["garment_seed"], record["wording"]): record for record in records}
