"""Language models side by side (the paper's Fig. 12): success, validity, failures, latency, tokens and cost.

The variants of a study are the models. What a model took stands in each record's ``language``, which is
:meth:`polyfold.transcript.Transcript.accounts`. What is not known is a dash, never 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from polyfold.analysis._results import Results
from polyfold.analysis._statistics import Estimate, ratio
from polyfold.analysis._tables import Table, shown

Record = Mapping[str, Any]


@dataclass(frozen=True)
class Measure:
    """A figure of a language model: a total over a count, both summed over episodes.

    Attributes:
        total: of an episode; None if unknown.
        count: what it is the total of; 0 leaves the episode out.
        digits: after the point.
    """

    total: Callable[[Record], float | None]
    count: Callable[[Record], float]
    digits: int = 1


def _one(record: Record) -> float:
    return 1.0


def _sum(name: str) -> Callable[[Record], float | None]:
    """The sum over an episode's roles; None if it is unknown for one, or if there was none."""

    def total(record: Record) -> float | None:
        values = [account.get(name) for account in record["language"].values()]
        return None if None in values or not values else sum(values)

    return total


def _complete(name: str) -> Callable[[Record], float | None]:
    """As :func:`_sum`, for what only replies report: unknown where a call brought none."""
    total, errors = _sum(name), _sum("errors")
    return lambda record: None if errors(record) else total(record)


def _share(name: str) -> Callable[[Record], float | None]:
    total = _sum(name)
    return lambda record: None if (value := total(record)) is None else 100.0 * value


def _failed(cause: str) -> Callable[[Record], float]:
    return lambda record: 100.0 * (record["cause"] == cause)


def _questions(record: Record) -> float:
    return _sum("questions")(record) or 0.0


def _replies(record: Record) -> float:
    return (_sum("calls")(record) or 0.0) - (_sum("errors")(record) or 0.0)


def _latency(record: Record) -> float | None:
    """Of all replies [s]; a backend that measures nothing says 0."""
    return _sum("latency_s")(record) or None


MEASURES: dict[str, Measure] = {
    "success %": Measure(lambda record: 100.0 * record["success"]["polyfold"], _one),
    "valid at once %": Measure(_share("valid_at_once"), _questions),
    "valid after repair %": Measure(_share("valid"), _questions),
    "subgoal failures %": Measure(_failed("subgoal"), _one),
    "fold-line failures %": Measure(_failed("fold line"), _one),
    "latency [s/call]": Measure(_latency, _replies, 2),
    "tokens in": Measure(_complete("prompt_tokens"), _one, 0),
    "tokens out": Measure(_complete("completion_tokens"), _one, 0),
    "cost [US$]": Measure(_complete("cost"), _one, 4),
}
"""Columns of the table. Tokens and cost are those of an episode."""


def measured(records: Sequence[Record], measure: str) -> Estimate:
    """A measure over the episodes of one variant, with its 95 % interval from resampled episodes."""
    found = MEASURES[measure]
    return ratio([found.total(record) for record in records], [found.count(record) for record in records])


def provider_table(results: Results) -> Table:
    """The variants of a study as language models, one a row; see :data:`MEASURES`.

    A cell that rests on fewer episodes than the row, because the others' figure is unknown, says on how many.
    """
    rows = []
    for variant in results.study.variants:
        records = results.of(variant)
        if records:
            rows.append([variant, str(len(records)), *(_cell(records, measure) for measure in MEASURES)])
    return Table(["model", "n", *MEASURES], rows, _note(results))


def _cell(records: Sequence[Record], measure: str) -> str:
    if measure.startswith("cost") and _is_free(records):
        return "free"
    found = measured(records, measure)
    text = shown(found, MEASURES[measure].digits)
    expected = sum(MEASURES[measure].count(record) > 0 for record in records)
    return text if found.n in (0, expected) else f"{text} (n={found.n})"


def _is_free(records: Sequence[Record]) -> bool:
    return _said(records, "cost_sources") == ["free"] and measured(records, "cost [US$]").mean == 0.0


def _said(records: Sequence[Record], name: str) -> list[str]:
    """What the accounts of some episodes list under a name, each once."""
    accounts = (account for record in records for account in record["language"].values())
    return sorted({text for account in accounts for text in account.get(name, ())})


def _note(results: Results) -> str:
    text = (
        f"{results.study.name}: mean [95 % bootstrap interval over episodes]; – is unknown. Valid: share of questions "
        "(decompositions, fold lines) with a first answer, or one in the end, that could be used. Failures: share of "
        "episodes whose first error is there. Latency: of calls that were answered, without failed tries and waits. "
        "Tokens and cost: per episode."
    )
    models = {variant: results.of(variant) for variant in results.study.variants}
    text += _listed("Cost by", {name: _said(of, "cost_sources") for name, of in models.items()}, leave_out="free")
    text += _listed("Answers", {name: _said(of, "origins") for name, of in models.items()}, leave_out="live")
    unanswered = {name: sum(_is_unanswered(record) for record in of) for name, of in models.items()}
    if any(unanswered.values()):
        counts = ", ".join(f"{name} {count}" for name, count in unanswered.items() if count)
        text += f" Episodes without an answer, counted as no success; run the study again to ask anew: {counts}."
    return text


def _is_unanswered(record: Record) -> bool:
    return record["failure"] is not None and record["failure"]["stage"] == "unanswered"


def _listed(what: str, said: Mapping[str, Iterable[str]], leave_out: str) -> str:
    """One sentence on which variants share what was said; empty if there is nothing."""
    sharing: dict[str, list[str]] = {}
    for variant, texts in said.items():
        for text in texts:
            sharing.setdefault(text, []).append(variant)
    parts = [f"{text} ({', '.join(variants)})" for text, variants in sharing.items() if text != leave_out]
    return f" {what}: {'; '.join(parts)}." if parts else ""
