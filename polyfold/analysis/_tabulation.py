"""Tables of a study: variants by group, paired differences, errors after each fold."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from polyfold.analysis._columns import Column, column_of, columns_of, shared
from polyfold.analysis._differences import holm
from polyfold.analysis._intervals import Estimate, mean
from polyfold.analysis._notes import about, interval, noise_floor, remarks
from polyfold.analysis._results import Results, check_results
from polyfold.analysis._tables import CERTAIN, Cell, Figure, Table
from polyfold.errors import ConfigError, did_you_mean
from polyfold.logs import StudyEpisodeRecord
from polyfold.types._views import makes, view_of

TEST = "not 0, p < 0.05 by exact McNemar and sign flips of sentences or garments, after Holm over the table's cells"

Key = Callable[[StudyEpisodeRecord], str | None]

GROUPS: Mapping[str, Key] = {
    "kind": lambda record: record.garment.kind,
    "type": lambda record: record.type,
    "task": lambda record: record.task,
    "split": lambda record: record.split,
    "wording": lambda record: _wording(record),
}
"""What rows can be made of; the groups ``none`` and ``step`` besides."""


def _hardest_first(records: Iterable[StudyEpisodeRecord]) -> list[StudyEpisodeRecord]:
    """In the study's order, but what nothing was tuned on before the rest."""
    return sorted(records, key=lambda record: not record.wording_unseen)


def _wording(record: StudyEpisodeRecord) -> str:
    """A wording by number; those that nothing was tuned on are marked."""
    return f"{record.wording}, unseen" if record.wording_unseen else str(record.wording)


def table(
    results: Results, columns: Sequence[str] | None = None, groups: str = "kind", noise: Results | None = None
) -> Table:
    """Variants by garment kind (``kind``), task type (``type``), ``task``, ``split``, ``wording``, ``step``, or all.

    Cells are means with 95 % intervals for other sentences and garments; n is the number of episodes.

    Args:
        results: what to tabulate.
        columns: headings, names of metrics or of criteria; by default every metric and criterion of the run.
        groups: what makes a row; ``step`` gives the mean particle error after each of the episode's own folds.
        noise: a study of what differs without meaning; it becomes a footnote (``experiments/noise_floor.toml``).
    """
    check_results(results)
    if groups == "step":
        return _by_step(results)
    if groups not in (*GROUPS, "none"):
        raise ConfigError(f"can't group by {groups!r}; choose one of {', '.join(GROUPS)}, none, step")
    chosen = _chosen(results, columns)
    rows: list[list[Cell]] = []
    for variant in results.study.variants:
        for group, records in _grouped(results, variant, groups):
            figures = [_mean(column, records) for column in chosen]
            rows.append([_marked(variant, records), group, str(len(records)), *figures])
    rows += _published(results, chosen, dict.fromkeys(str(row[1]) for row in rows))
    headers = ["variant", groups if groups != "none" else "", "n", *(column.heading for column in chosen)]
    note = about(results)
    return Table(headers, rows, note if noise is None else f"{note} {noise_floor(noise)}")


@makes(Results, "html")
def _html(results: Results) -> str:
    return view_of(table(results), "rich")


def _chosen(results: Results, columns: Sequence[str] | None) -> list[Column]:
    if columns is None:
        return columns_of(results.run)
    return [column_of(results.run, name) for name in columns]


def _by_step(results: Results) -> Table:
    most = max((len(record.step_errors_mm) for record in results.records), default=0)
    rows: list[list[Cell]] = []
    for variant in results.study.variants:
        for kind, records in _grouped(results, variant, "kind"):
            rows.append([_marked(variant, records), kind, *(_after(step, records) for step in range(most))])
    note = f"{results.study.name}: mean particle error [mm] after each fold of the episode's own."
    note += remarks(results)
    return Table(["variant", "kind", *(f"step {step + 1}" for step in range(most))], rows, note)


def _after(step: int, records: Sequence[StudyEpisodeRecord]) -> Cell:
    there = [record for record in records if len(record.step_errors_mm) > step]
    if not there:
        return "–"
    return Figure(mean([record.step_errors_mm[step] for record in there], *shared(there)), note=f"(n={len(there)})")


def _published(results: Results, columns: Sequence[Column], groups: Iterable[str]) -> list[list[Cell]]:
    """Rows of what others published, which is success alone."""
    return [
        [label, group, "–", *(f"{figures[group]:.1f}" if column.heading == "success %" else "–" for column in columns)]
        for label, figures in results.study.published.items()
        for group in groups
        if group in figures
    ]


def _mean(column: Column, records: Sequence[StudyEpisodeRecord]) -> Figure:
    return Figure(column.over(records), column.digits)


def _marked(variant: str, records: Sequence[StudyEpisodeRecord]) -> str:
    return f"{variant} *" if any(record.privileged for record in records) else variant


def _grouped(results: Results, variant: str, groups: str) -> list[tuple[str, list[StudyEpisodeRecord]]]:
    """Records of a variant by group, groups in the study's order, then all of them."""
    mine = results.of(variant)
    found: list[tuple[str, list[StudyEpisodeRecord]]] = []
    if groups != "none":
        key = GROUPS[groups]
        names = results.kinds() if groups == "kind" else dict.fromkeys(map(key, _hardest_first(results.records)))
        found = [(name or "–", [record for record in mine if key(record) == name]) for name in names]
    found.append(("all", mine))
    return [(name, records) for name, records in found if records]


def compare(
    results: Results, variant: str | None = None, baseline: str | None = None, columns: Sequence[str] | None = None
) -> Table:
    """Paired differences between variants on the same tasks, garments and wordings.

    Args:
        results: of a study that has both.
        variant: which one; by default every other, one below the other.
        baseline: what it is compared with; the difference is variant − baseline. By default the study's first.
        columns: as in :func:`table`.

    Raises:
        ConfigError: if the study has no such variant, or one alone.
    """
    check_results(results)
    variants = list(results.study.variants)
    for name in (variant, baseline):
        if name is not None and name not in variants:
            raise ConfigError(f"there is no variant {name!r}; {did_you_mean(name, variants)}")
    base = baseline or next((name for name in variants if name != variant), variants[0])
    ours = [variant] if variant is not None else [name for name in variants if name != base]
    if not ours:
        raise ConfigError(f"{results.study.name} has one variant, {base!r}; there is nothing to compare it with")
    chosen = _chosen(results, columns)
    found = [(one, kind, *paired) for one in ours for kind, paired in _pairs(results, one, base, chosen)]
    adjusted = iter(holm([estimate.p for *_, estimates in found for estimate in estimates]))
    rows: list[list[Cell]] = [
        [
            *([] if variant is not None else [one]),
            kind,
            str(n),
            *(_difference(column, value, next(adjusted)) for column, value in zip(chosen, estimates, strict=True)),
        ]
        for one, kind, n, estimates in found
    ]
    what = variant or "variant"
    note = f"{what} − {base}, the same episodes; mean [{interval(results)}]. {CERTAIN}: {TEST}.{remarks(results)}"
    headers = [*([] if variant is not None else ["variant"]), "kind", "n", *(column.heading for column in chosen)]
    return Table(headers, rows, note)


def _pairs(
    results: Results, variant: str, baseline: str, columns: Sequence[Column]
) -> Iterator[tuple[str, tuple[int, list[Estimate]]]]:
    """By kind and over all: on how many episodes that both have, and the differences, a column each."""
    ours, theirs = (_by_episode(results.of(name)) for name in (variant, baseline))
    both = [key for key in ours if key in theirs]
    for kind in [*results.kinds(), "all"]:
        keys = [key for key in both if kind in ("all", ours[key].garment.kind)]
        if keys:
            pair = [ours[key] for key in keys], [theirs[key] for key in keys]
            yield kind, (len(keys), [column.between(*pair) for column in columns])


def _difference(column: Column, value: Estimate, adjusted: float | None) -> Figure:
    return Figure(value, column.digits, signed=True, certain=adjusted is not None and adjusted < 0.05)


def _by_episode(records: Sequence[StudyEpisodeRecord]) -> dict[tuple[Any, ...], StudyEpisodeRecord]:
    return {(record.task, record.garment.seed, record.wording): record for record in records}
