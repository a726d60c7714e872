"""A study that asks for further variants or more garments keeps what it has and runs the rest."""

import pytest

import polyfold
from polyfold.errors import ConfigError
from polyfold.logs import read_run

SMALL = {"name": "small", "tasks": ("square-corner-top_*",), "first_seed": 2000, "edge_length": 0.05}
TWO = {"farthest": {"policy": "farthest"}, "caso": {"policy": "caso"}}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))


def study(**others):
    return polyfold.Study(**{**SMALL, "variants": {"farthest": TWO["farthest"]}, **others})


def test_further_variants_and_garments_are_added_to_what_is_finished(tmp_path):
    first = polyfold.run(study(), tmp_path / "run", progress=False)
    grown = polyfold.run(study(variants=TWO, garments=2), tmp_path / "run", progress=False)
    whole = polyfold.run(study(variants=TWO, garments=2), tmp_path / "whole", progress=False)
    assert len(first.records) == 2
    assert [record.key for record in grown.records] == [record.key for record in whole.records]
    assert len(grown.records) == 8
    assert [record.finished for record in grown.records if record.key in {r.key for r in first.records}] == [
        record.finished for record in first.records
    ], "what was finished was not folded again"
    assert polyfold.table(grown).rows == polyfold.table(whole).rows
    opened = polyfold.open(tmp_path / "run")
    assert set(opened.study.variants) == {"farthest", "caso"}
    run = read_run(tmp_path / "run")
    assert not run.changes
    assert run.fingerprint == read_run(tmp_path / "whole").fingerprint
    assert set(run.components) == {"farthest", "caso"}


def test_a_study_that_is_another_or_asks_for_less_is_still_refused(tmp_path):
    polyfold.run(study(variants=TWO), tmp_path, progress=False)
    for other in (study(), study(variants={**TWO, "caso": {"policy": "affordance-pair"}}), study(variants=TWO, seed=1)):
        with pytest.raises(ConfigError, match="another configuration"):
            polyfold.run(other, tmp_path, progress=False)
    assert set(polyfold.open(tmp_path).study.variants) == set(TWO)


def test_code_that_changed_meanwhile_is_still_refused(tmp_path):
    from polyfold.logs._run_directory import DESCRIPTION

    polyfold.run(study(), tmp_path, progress=False)
    said = (tmp_path / DESCRIPTION).read_text()
    name, old = next(iter(read_run(tmp_path).fingerprint.sources.items()))
    (tmp_path / DESCRIPTION).write_text(said.replace(old, "0" * 64))
    with pytest.raises(ConfigError, match=f"source of {name}"):
        polyfold.run(study(variants=TWO), tmp_path, progress=False)
    assert list(polyfold.open(tmp_path).study.variants) == ["farthest"], "what is refused changes nothing"
    grown = polyfold.run(study(variants=TWO), tmp_path, progress=False, accept_change=True)
    assert len(grown.records) == 4
    assert len(read_run(tmp_path).changes) == 1
