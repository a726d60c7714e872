"""Oracle references are kept for the next run, and a cache that is damaged or can't be written costs time alone."""

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.evaluation import suite
from polyfold.evaluation._references import _mention, reference_for

TASK = "square-corner-top_left"


@pytest.fixture
def reference(monkeypatch, tmp_path):
    """Computes a reference, or reads it, with the cache in a folder of the test's own."""
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    _mention.cache_clear()
    garment = plugins.generate_garment("square", 2000, 0.05)
    task = suite("polyfold70").task(TASK)
    return lambda: reference_for(task, garment, 2000, ComponentSpec(name="xpbd"))


def positions(found):
    return found.outcome.end.positions


def test_it_is_read_the_second_time(reference, monkeypatch, recwarn):
    first = reference()
    monkeypatch.setattr("polyfold.evaluation._references.run_episode", None)
    np.testing.assert_array_equal(positions(reference()), positions(first))
    assert not recwarn.list


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 and no more", b"not an archive"])
def test_a_damaged_one_is_computed_anew(reference, tmp_path, damage):
    first = reference()
    (file,) = (tmp_path / "cache" / "references").iterdir()
    file.write_bytes(damage)
    with pytest.warns(UserWarning, match=r"is damaged .*computed anew; set POLYFOLD_CACHE"):
        again = reference()
    np.testing.assert_array_equal(positions(again), positions(first))
    assert file.stat().st_size > 1000, "and kept again"


def test_without_a_place_to_keep_it_the_run_goes_on(reference, tmp_path):
    (tmp_path / "cache").write_text("a file in the folder's place")
    with pytest.warns(UserWarning, match="references can't be kept"):
        first = reference()
    np.testing.assert_array_equal(positions(reference()), positions(first))


def test_a_study_survives_it(monkeypatch, tmp_path):
    (tmp_path / "cache").write_text("a file in the folder's place")
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    study = polyfold.Study(
        name="s", tasks=(TASK,), garments=1, first_seed=2000, edge_length=0.05, instructions="first", reference="oracle"
    )
    _mention.cache_clear()
    with pytest.warns(UserWarning, match="references can't be kept"):
        polyfold.run(study, tmp_path / "run", progress=False)
    assert len((tmp_path / "run" / "episodes.jsonl").read_text("utf-8").splitlines()) == 1
