"""Language models side by side (the paper's Fig. 12): success, validity, failures, latency, tokens and cost.

The variants of a study are the models. What a model took stands in each record's ``language``, which is
:class:`polyfold.logs.Account` by role. What is not known is a dash, never 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from polyfold.analysis._columns import shared
from polyfold.analysis._intervals import Estimate, ratio, share_of
from polyfold.analysis._results import Results
from polyfold.analysis._tables import Cell, Figure, Table
from polyfold.logs import StudyEpisodeRecord
from polyfold.logs._accounts import Account

Taken = Callable[[Account], float | None]
"""What a role took of something; None if it is unknown."""


@dataclass(frozen=True)
class Measure:
    """A figure of a language model: a total over a count, both summed over episodes.

    Attributes:
        total: of an episode; None if unknown.
        count: what it is the total of; 0 leaves the episode out.
        digits: after the point.
        is_share: whether it is a share [%].
    """

    total: Callable[[StudyEpisodeRecord], float | None]
    count: Callable[[StudyEpisodeRecord], float]
    digits: int = 1
    is_share: bool = False


def _one(record: StudyEpisodeRecord) -> float:
    return 1.0


def _asked(record: StudyEpisodeRecord) -> float:
    """1 where a language model was asked anything: others can't have failed for its sake."""
    return 1.0 if record.language else 0.0


def _total(record: StudyEpisodeRecord, taken: Taken) -> float | None:
    """The sum over an episode's roles; None if it is unknown for one, or if there was none."""
    values = [taken(account) for account in record.language.values()]
    known = [value for value in values if value is not None]
    return sum(known) if values and len(known) == len(values) else None


def _answered(record: StudyEpisodeRecord, taken: Taken) -> float | None:
    """The sum of what only replies report: unknown where a call brought none."""
    return None if _total(record, lambda account: account.errors) else _total(record, taken)


def _questions(record: StudyEpisodeRecord) -> float:
    return _total(record, lambda account: account.questions) or 0.0


def _replies(record: StudyEpisodeRecord) -> float:
    return _total(record, lambda account: account.calls - account.errors) or 0.0


def _latency(record: StudyEpisodeRecord) -> float | None:
    """Of all replies [s]; a backend that measures nothing says 0."""
    return _total(record, lambda account: account.latency_s) or None


MEASURES: dict[str, Measure] = {
    "success %": Measure(lambda record: float(record.succeeded), _one, is_share=True),
    "valid at once %": Measure(
        lambda record: _total(record, lambda account: account.valid_at_once), _questions, is_share=True
    ),
    "valid after repair %": Measure(
        lambda record: _total(record, lambda account: account.valid), _questions, is_share=True
    ),
    "subgoal failures %": Measure(lambda record: float(record.cause == "subgoal"), _asked, is_share=True),
    "fold-line failures %": Measure(lambda record: float(record.cause == "fold line"), _asked, is_share=True),
    "latency [s/call]": Measure(_latency, _replies, 2),
    "tokens in": Measure(lambda record: _answered(record, lambda account: account.prompt_tokens), _one, 0),
    "cached %": Measure(
        lambda record: _answered(record, lambda account: account.cached_tokens),
        lambda record: _answered(record, lambda account: account.prompt_tokens) or 0.0,
        0,
        is_share=True,
    ),
    "tokens out": Measure(lambda record: _answered(record, lambda account: account.completion_tokens), _one, 0),
    "cost [US$]": Measure(lambda record: _answered(record, lambda account: account.cost), _one, 4),
}
"""Columns of the table. Tokens and cost are those of an episode."""


def measured(records: Sequence[StudyEpisodeRecord], measure: str) -> Estimate:
    """A measure over the episodes of one variant, with its 95 % interval for other sentences and garments."""
    found = MEASURES[measure]
    totals, counts = [found.total(record) for record in records], [found.count(record) for record in records]
    return (share_of if found.is_share else ratio)(totals, counts, *shared(records))


def provider_table(results: Results) -> Table:
    """The variants of a study as language models, one a row; see :data:`MEASURES`.

    A cell that rests on fewer episodes than the row, because the others' figure is unknown, says on how many.
    """
    rows: list[list[Cell]] = []
    for variant in results.study.variants:
        records = results.of(variant)
        if records:
            rows.append([variant, str(len(records)), *(_cell(records, measure) for measure in MEASURES)])
    return Table(["model", "n", *MEASURES], rows, _note(results))


def _cell(records: Sequence[StudyEpisodeRecord], measure: str) -> Cell:
    if measure.startswith("cost") and is_free(records):
        return "free"
    found = measured(records, measure)
    expected = sum(MEASURES[measure].count(record) > 0 for record in records)
    return Figure(found, MEASURES[measure].digits, note="" if found.n in (0, expected) else f"(n={found.n})")


def is_free(records: Sequence[StudyEpisodeRecord]) -> bool:
    """Whether the variant's models cost nothing, as those that run on one's own machine do."""
    sources = _said(records, lambda account: account.cost_sources)
    return sources == ["free"] and measured(records, "cost [US$]").mean == 0.0


def _said(records: Sequence[StudyEpisodeRecord], said: Callable[[Account], Iterable[str]]) -> list[str]:
    """What the accounts of some episodes list, each once."""
    accounts = (account for record in records for account in record.language.values())
    return sorted({text for account in accounts for text in said(account)})


def _note(results: Results) -> str:
    text = (
        f"{results.study.name}: mean [95 % interval for other sentences and garments]; – is unknown. Valid: share of "
        "questions (decompositions, fold lines) with a first answer, or one in the end, that could be used. Failures: "
        "share of episodes whose first error is there. Latency: of calls that were answered, without failed tries and "
        "waits. Tokens and cost: per episode."
    )
    models = {variant: results.of(variant) for variant in results.study.variants}
    text += _listed(
        "Cost by",
        {name: _said(of, lambda account: account.cost_sources) for name, of in models.items()},
        leave_out="free",
    )
    text += _listed(
        "Answers", {name: _said(of, lambda account: account.origins) for name, of in models.items()}, leave_out="live"
    )
    unanswered = {name: sum(record.unanswered for record in of) for name, of in models.items()}
    if any(unanswered.values()):
        counts = ", ".join(f"{name} {count}" for name, count in unanswered.items() if count)
        text += f" Episodes without an answer, counted as no success; run the study again to ask anew: {counts}."
    return text


def _listed(what: str, said: Mapping[str, Iterable[str]], leave_out: str) -> str:
    """One sentence on which variants share what was said; empty if there is nothing."""
    sharing: dict[str, list[str]] = {}
    for variant, texts in said.items():
        for text in texts:
            sharing.setdefault(text, []).append(variant)
    parts = [f"{text} ({', '.join(variants)})" for text, variants in sharing.items() if text != leave_out]
    return f" {what}: {'; '.join(parts)}." if parts else ""
