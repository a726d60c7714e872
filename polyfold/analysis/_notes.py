"""What stands below a table: what is compared with what, who answered, which sentences and fabrics, at which commit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from polyfold.analysis._columns import Column, columns_of, shared
from polyfold.analysis._results import Results
from polyfold.errors import ConfigError
from polyfold.logs import StudyEpisodeRecord

REFERENCES = {
    "oracle": "the oracle from the same start",
    "ideal": "the flat garment folded geometrically along the task's lines, as thick as its fabric",
}
"""What results are compared with, in words."""


INTERVALS = (
    "Intervals are of 95 %, for other sentences and other garments: episodes that share either are not taken for "
    "independent. Of shares they are Wilson's, with as many episodes as independent ones would say as much; of errors "
    "and times, studentised with a correction for skewness (Hall 1992)."
)
"""How all intervals of tables and reports are made; see :mod:`polyfold.analysis._intervals`."""

ORACLE = "oracle"
"""The agent that shows which tasks are fit to judge others by."""

ORDER = "order"
"""The simulator's setting for the order of its particles and contacts."""

NAMED = 4
"""So many unfit tasks are named."""


def interval(results: Results) -> str:
    """What the intervals of a table hold for: what there is only one of is not generalised over."""
    sentences, garments = (set(labels) for labels in shared(results.records))
    several = [name for name, found in (("sentences", sentences), ("garments", garments)) if len(found) > 1]
    single = [name for name, found in (("sentence", sentences), ("garment", garments)) if len(found) == 1]
    alone = f" and this one {' and '.join(single)}" if single else ""
    return f"95 % interval for other {' and '.join(several)}{alone}" if several else "no interval, of one episode"


def about(results: Results) -> str:
    """What a reader must know of a table of means before the figures mean anything."""
    study = results.study
    parts = [f"{study.name}: mean [{interval(results)}]; reference: {REFERENCES[study.reference]}"]
    return ". ".join([*parts, *filter(None, (_unfit(results), _made_with(results)))]) + "." + remarks(results)


def remarks(results: Results) -> str:
    """What a reader of any table must know of how its episodes came about."""
    note = ""
    if any(record.steps_wanted is None for record in results.records):
        note += " Goals: the nearest task that each accepts; success includes those that are done by their own bounds."
    if any(record.privileged for record in results.records):
        note += " * privileged: sees more than the camera."
    note += _refusals(results)
    for change in results.run.changes:
        note += f" Went on after {change.episodes} episodes with a change: {'; '.join(change.differences)}."
    return note


def _refusals(results: Results) -> str:
    """How many sentences each variant refused: that cloth lies as it lay, however few millimetres it is off."""
    told = []
    for variant in results.study.variants:
        records = results.of(variant)
        failures = [record.failure.stage for record in records if record.failure is not None]
        refused = failures.count("refused")
        if refused:
            told.append(f"{refused} of {len(records)} by {variant}")
    return f" Refused, and not folded any further: {', '.join(told)}." if told else ""


def noise_floor(noise: Results) -> str:
    """How far episodes differ that differ in nothing that matters, as a sentence.

    Args:
        noise: a study whose variants have their particles and contacts in other orders.
    """
    if not _differ_in_order_alone(noise):
        raise ConfigError(
            f"{noise.study.name} has no variants that differ in the order of particles and in nothing more, so that it "
            "tells of no noise; give a run of experiments/noise_floor.toml"
        )
    first, *others = noise.study.variants
    known = {_place(record): record for record in noise.of(first)}
    pairs = [(known[_place(r)], r) for name in others for r in noise.of(name) if _place(r) in known]
    columns = ", ".join(f"{column.heading} {_apart(column, pairs)}" for column in columns_of(noise.run))
    kinds = ", ".join(noise.kinds())
    same = f"the same folds with particles and contacts in another order (n={len(pairs)}: {kinds})"
    return f"Noise floor: {same} differ by {columns}."


def _differ_in_order_alone(noise: Results) -> bool:
    """Whether the variants are the same but for the order in which the simulator has its particles."""
    orders, others = [], []
    for variant in noise.study.variants:
        components = dict(noise.run.components.get(variant, {}))
        simulator = components.pop("simulator", None)
        if simulator is None:
            return False
        orders.append(simulator.params.get(ORDER))
        others.append((simulator.name, {**simulator.params, ORDER: None}, components))
    return all(other == others[0] for other in others) and len(set(orders)) == len(orders) > 1


def _place(record: StudyEpisodeRecord) -> tuple[str | None, str, int | None, int]:
    return record.task, record.garment.kind, record.garment.seed, record.wording


def _apart(column: Column, pairs: Sequence[tuple[StudyEpisodeRecord, StudyEpisodeRecord]]) -> str:
    """The mean absolute difference between two episodes."""
    values = [(column.value(one), column.value(other)) for one, other in pairs]
    known = [abs(a - b) for a, b in values if a is not None and b is not None]
    return f"{math.fsum(known) / len(known):.{column.digits}f}" if known else "–"


def _unfit(results: Results) -> str:
    """On which tasks and garments the oracle itself misses the reference, if it was asked."""
    asked = [record for record in results.records if record.agent == ORACLE and record.compared]
    if not asked:
        return ""
    if results.study.reference == ORACLE:
        return "The oracle's own row is compared with itself"
    counts = []
    for criterion in results.run.criteria:
        missed = [record for record in asked if not record.success[criterion]]
        places = [f"{record.task} on garment {record.garment.seed}" for record in missed]
        more = f" and {len(places) - NAMED} more" if len(places) > NAMED else ""
        which = f" ({', '.join(places[:NAMED])}{more})" if places else ""
        counts.append(f"{len(missed)} {criterion}{which}")
    return f"Unfit to judge by, since the oracle misses the reference there, of {len(asked)}: {'; '.join(counts)}"


def _made_with(results: Results) -> str:
    """Who answered, on which sentences and fabrics, at which commit."""
    found = [_answered(results), _wordings(_reading(results)), _fabrics(results), _commit(results)]
    said = "; ".join(part for part in found if part)
    return said[:1].upper() + said[1:]


_OWN = ("offline", "rules")
"""Solvers of this project, which are no language models; earlier releases had the second."""


def _answered(results: Results) -> str:
    names: dict[str, str] = {}
    for variant, components in results.run.components.items():
        spec = components.get("llm")
        if spec is not None and variant in results.study.variants:
            name = spec.name
            names[variant] = f"{name} (a solver of this project, no language model)" if name in _OWN else name
    if not names:
        return ""
    if len(set(names.values())) == 1:
        return f"sentences answered by {next(iter(names.values()))}"
    return "sentences answered by " + ", ".join(f"{name} in {variant}" for variant, name in names.items())


def _reading(results: Results) -> list[StudyEpisodeRecord]:
    """The episodes whose agent read the sentence."""
    readers = {variant for variant, components in results.run.components.items() if "llm" in components}
    return [record for record in results.records if record.variant in readers]


def _wordings(records: Iterable[StudyEpisodeRecord]) -> str:
    """Which of the tasks' sentences were said, and which of them nothing was tuned on."""
    said = {record.wording: record.wording_unseen for record in records if record.instruction}
    if not said or set(said.values()) == {None}:
        return ""
    shown = f"wording{'s' * (len(said) > 1)} {', '.join(map(str, sorted(said)))}"
    unseen = [str(number) for number, held_out in sorted(said.items()) if held_out]
    if len(unseen) == len(said):
        return f"{shown}, on which nothing was tuned"
    if unseen:
        return f"{shown}, of which nothing was tuned on {', '.join(unseen)}"
    return f"{shown}, {'none of them unseen' if len(said) > 1 else 'not an unseen one'}"


def _fabrics(results: Results) -> str:
    found = dict.fromkeys(r.garment.fabric.name for r in results.records if r.garment.fabric is not None)
    return f"fabrics {', '.join(sorted(found))}" if found else ""


def _commit(results: Results) -> str:
    known = results.run.fingerprint
    if known is None or not known.git:
        return ""
    state = next(iter(known.git.values()))
    return f"commit {state.commit[:7]}" + (" with changes" if state.dirty else "")
