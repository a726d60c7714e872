"""Demonstrations: what is seen, done and wanted, gone on with after kills, and never mixed with others."""

import re

import numpy as np
import pytest
from demo_plan import PLAN
from hypothesis import given
from hypothesis import strategies as st
from polyfold_baselines.demos.command import collect
from polyfold_baselines.demos.pictures import sheet
from polyfold_baselines.demos.store import DemoFolder, Demos
from polyfold_baselines.demos.window import SIDE, Window

from polyfold.cli import main
from polyfold.errors import ConfigError

across = st.floats(-50, 450)


@given(st.tuples(across, across), st.floats(20, 600), st.tuples(across, across))
def test_pixels_go_into_the_view_and_back(centre, side, point):
    window = Window(centre, side)
    assert np.allclose(window.to_pixels(window.to_view([point])), [point], atol=1e-6)


@given(st.integers(60, 340), st.integers(60, 340), st.floats(80, 300))
def test_what_is_seen_at_a_pixel_is_in_the_view_where_that_pixel_goes(x, y, side):
    picture = np.zeros((400, 400))
    picture[y - 3 : y + 4, x - 3 : x + 4] = 1.0
    window = Window((float(x) + 5.0, float(y) - 7.0), side)
    seen = window.view(picture)
    rows, columns = np.indices(seen.shape)
    found = [(columns * seen).sum() / seen.sum(), (rows * seen).sum() / seen.sum()]
    assert np.allclose(found, window.to_view([[x, y]])[0], atol=0.3)


def test_a_fold_is_seen_done_and_wanted(demonstrated):
    demos = Demos.read(demonstrated)
    columns = demos.columns
    assert set(columns["task"]) == set(PLAN.tasks)
    assert (columns["error_mm"] < 25).all()
    for row, mask in enumerate(demos.masks):
        assert 0.05 < mask.mean() < 0.9
        picks = columns["picks"][row]
        for x, y in picks[np.isfinite(picks[:, 0])]:
            near = mask[max(0, round(y) - 3) : round(y) + 4, max(0, round(x) - 3) : round(x) + 4]
            assert near.any(), "picks are on the cloth"
        ends = columns["places"][row]
        assert (np.linalg.norm(ends - picks, axis=1)[np.isfinite(picks[:, 0])] > 5).all()
    several = columns["steps"] == 2
    assert several.any()
    first, last = (several & (columns["step"] == step) for step in (0, 1))
    assert (columns["end"][first] == np.flatnonzero(last)).all()
    goal, later = columns["goal_height"][first][0], columns["height"][last][0]
    assert np.abs(goal.astype(int) - later)[demos.masks[last][0]].mean() < 400, "what is wanted is what comes next"


def test_a_folder_is_gone_on_with_and_says_by_a_hash_what_it_holds(demonstrated, tmp_path):
    out = tmp_path / "demos"
    small = PLAN.model_copy(update={"tasks": PLAN.tasks[:1]})
    once = collect(small, out, progress=False)
    (out / "shards" / "00001.npz").unlink()
    (out / "shards" / "00002.part77").write_bytes(b"half")
    assert collect(small, out, progress=False) == once
    assert not list(out.rglob("*.part*"))
    with pytest.raises(ConfigError, match="other demonstrations"):
        collect(PLAN, out, progress=False)
    (out / "shards" / "00000.npz").write_bytes(b"damaged")
    with pytest.raises(ConfigError, match="damaged"):
        Demos.read(out)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--tasks", "square-corner-nowhere"], "no task .*square-corner-nowhere.* did you mean"),
        (["--tasks", "square-corner-top_left"], "no seen task.*--split unseen"),
        (["--edge-length", "9"], "edge_length"),
    ],
)
def test_what_can_not_be_demonstrated_is_said(tmp_path, capsys, arguments, says):
    assert main(["demos", "--out", str(tmp_path / "out"), *arguments]) == 1
    assert re.search(says, capsys.readouterr().err)
    assert not (tmp_path / "out").exists()


def test_tasks_are_chosen_by_patterns_as_elsewhere():
    plan = PLAN.model_copy(update={"tasks": ("square-corner-*", "pants-*"), "seeds": (1000, 1000)})
    named = [task.id for task, _ in plan.jobs()]
    assert {name.partition("-")[0] for name in named} == {"square", "pants"}
    assert all(task.split == "seen" for task, _ in plan.jobs())
    assert any(name.startswith("square-corner-") for name in named)
    assert len(named) == len(set(named))


def test_demonstrations_show_themselves(demonstrated):
    picture = sheet(Demos.read(demonstrated), 4)
    assert picture.ndim == 3
    assert picture.shape[0] > SIDE


def test_unfinished_ones_teach_nothing(tmp_path):
    with pytest.raises(ConfigError, match="there are no demonstrations"):
        Demos.read(tmp_path)
    DemoFolder(tmp_path, PLAN)
    with pytest.raises(ConfigError, match="not finished"):
        Demos.read(tmp_path)
