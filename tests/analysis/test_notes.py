"""A table says what its figures are worth: who answered, on which sentences, and which tasks are no measure."""

from dataclasses import replace

import pytest

import polyfold
from polyfold.analysis._columns import columns_of
from polyfold.cli import main
from polyfold.errors import ConfigError

SETTINGS = {"tasks": ("square-corner-*", "square-triangle-top_left"), "first_seed": 2000, "edge_length": 0.03}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("notes")


@pytest.fixture(scope="module")
def results(folder):
    base = polyfold.Study(name="notes", instructions="all", **SETTINGS)
    study = polyfold.ablate(base, "agent", ["polyfold", "oracle"])
    return polyfold.run(study, folder, progress=False)


@pytest.fixture
def partly_unseen(results):
    """The same run as if nothing had been tuned on the last two wordings."""
    records = [r.model_copy(update={"wording_unseen": r.wording in (3, 4)}) for r in results.records]
    return replace(results, records=records)


def test_a_table_names_what_answered_the_wordings_the_fabric_and_the_commit(results):
    note = polyfold.table(results).note
    assert "folded geometrically" in note
    assert "answered by offline (a solver of this project, no language model)" in note
    assert "wordings 0, 1, 2, 3, 4, none of them unseen" in note
    assert "fabrics poplin" in note


def test_wordings_that_nothing_was_tuned_on_can_be_had_alone_and_lead(partly_unseen):
    assert "of which nothing was tuned on 3, 4" in polyfold.table(partly_unseen).note
    unseen, seen = partly_unseen.of_wordings("unseen"), partly_unseen.of_wordings("seen")
    assert {record.wording for record in unseen.records} == {3, 4}
    assert len(unseen.records) + len(seen.records) == len(partly_unseen.records)
    assert "wordings 3, 4, on which nothing was tuned" in polyfold.table(unseen).note
    assert "wordings 0, 1, 2, none of them unseen" in polyfold.table(seen).note
    groups = [row[1] for row in polyfold.table(partly_unseen, groups="wording").rows if row[0] == "polyfold"]
    assert groups == ["3, unseen", "4, unseen", "0", "1", "2", "all"]


def test_wordings_can_be_had_by_number(results, folder, capsys):
    some = results.of_wordings((1, 4))
    assert {record.wording for record in some.records} == {1, 4}
    assert main(["table", str(folder), "--wordings", "1,4", "--by", "wording"]) == 0
    rows = [line.split(" | ")[1] for line in capsys.readouterr().out.splitlines() if line.startswith("| polyfold")]
    assert rows == ["1", "4", "all"]
    with pytest.raises(ConfigError, match="no episode of notes is of a wording 7"):
        results.of_wordings([7])
    with pytest.raises(ConfigError, match="no episode of notes is of an unseen wording"):
        results.of_wordings("unseen")
    with pytest.raises(ConfigError, match="for example unseen, or 3,4"):
        results.of_wordings("new")


def test_a_choice_that_leaves_no_episode_is_said(results):
    with pytest.raises(ConfigError, match="no episode of notes is of a task of several folds"):
        results.of_length("multi")


def test_intervals_claim_no_other_garments_where_there_was_one(results):
    assert "95 % interval for other sentences and this one garment" in polyfold.table(results).note


def test_the_noise_floor_is_of_runs_that_differ_in_order_alone(results):
    with pytest.raises(ConfigError, match="differ in the order of particles and in nothing more"):
        polyfold.table(results, noise=results)


def test_a_suite_that_says_nothing_of_its_wordings_has_none_that_are_unseen(results, tmp_path):
    study = polyfold.Study(name="goals", suite="ambiguous", tasks=("napkin-smaller-square",), edge_length=0.03)
    other = polyfold.run(study, tmp_path, progress=False)
    with pytest.raises(ConfigError, match="doesn't say which wordings"):
        other.of_wordings("unseen")
    assert "tuned on" not in polyfold.table(other).note


def test_tasks_that_the_oracle_misses_are_counted_and_named(results):
    """At 30 mm a corner's crease takes up much of its flap."""
    missed = [record for record in results.of("oracle") if not record.success["strict"]]
    note = polyfold.table(results).note
    count = f"of {len(results.of('oracle'))}: 0 lenient; {len(missed)} strict"
    assert f"Unfit to judge by, since the oracle misses the reference there, {count}" in note
    assert all(f"{record.task} on garment 2000" in note for record in missed[:4])
    assert "Unfit" not in polyfold.table(polyfold.analysis.Results(results.run, results.of("polyfold"))).note


def test_the_mean_of_an_error_has_no_negative_interval(results):
    """Few garments, some of which fail badly: symmetric about the mean, the interval would reach below 0."""
    column = next(column for column in columns_of(results.run) if column.heading == "MPPE [mm]")
    records = results.of("polyfold")
    errors = [0.1] * (len(records) - 1) + [90.0]
    made = [r.model_copy(update={"metrics": {"mppe": e}}) for r, e in zip(records, errors, strict=True)]
    assert column.over(made).low == 0.0
    assert column.between(made, made[::-1]).low < 0


def test_no_interval_passes_what_a_metric_can_have(results):
    column = next(column for column in columns_of(results.run) if column.heading == "quality")
    records = results.of("polyfold")
    values = [100.0] * (len(records) - 1) + [10.0]
    made = [r.model_copy(update={"metrics": {"quality": v}}) for r, v in zip(records, values, strict=True)]
    assert column.over(made).high == 100.0


def test_a_table_tells_how_many_sentences_were_refused(results):
    from polyfold.types import Failure

    assert "Refused" not in polyfold.table(results).note
    refused = [r.model_copy(update={"failure": Failure("refused", "unclear")}) for r in results.of("polyfold")[:2]]
    some = replace(results, records=[*refused, *results.of("polyfold")[2:], *results.of("oracle")])
    count = len(some.of("polyfold"))
    assert f"Refused, and not folded any further: 2 of {count} by polyfold." in polyfold.table(some).note
