"""Suites of plugins: one that can't be read takes no fold down."""

import pytest

import polyfold
from polyfold import plugins
from polyfold.evaluation import known_tasks


@pytest.fixture
def broken(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("schema_version = 1\nname =")
    polyfold.register("tasks", "broken", str(path))
    yield
    plugins.unregister("tasks", "broken")


def test_a_suite_that_cannot_be_read_is_passed_over_with_a_warning(broken):
    with pytest.warns(UserWarning, match="its suite 'broken' was passed over.*correct it"):
        tasks = known_tasks("square")
    assert "square-triangle-top_left" in {task.id for task in tasks}


def test_folding_goes_on_beside_a_suite_that_cannot_be_read(broken):
    with pytest.warns(UserWarning, match="broken"):
        episode = polyfold.fold("fold it in half", polyfold.garment("square", seed=2000, edge_length=0.03))
    assert episode.fidelity is not None
