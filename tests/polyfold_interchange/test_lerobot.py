"""Folds as a LeRobotDataset: the layout, the numbers, the pictures; and read by ``lerobot`` where it is installed."""

import json

import numpy as np
import pytest

import polyfold
from polyfold.cli import main
from polyfold.errors import ConfigError

pq = pytest.importorskip("pyarrow.parquet")
av = pytest.importorskip("av")
from polyfold_interchange.lerobot import CAMERA, Recording, write_dataset  # noqa: E402
from polyfold_interchange.numbers import as_action  # noqa: E402


@pytest.fixture(scope="module")
def episodes():
    square = polyfold.garment("square", 0, edge_length=0.04)
    with polyfold.play(square) as playground:
        playground.fold(polyfold.FoldLine((200.0, 320.0), (200.0, 80.0)))
        playground.fold("fold the top edge to the bottom edge")
        by_hand = playground.episode
    return [polyfold.fold("fold it in half", square), by_hand]


@pytest.fixture(scope="module")
def folder(episodes, tmp_path_factory):
    return write_dataset(episodes, tmp_path_factory.mktemp("lerobot") / "mine")


def test_the_layout_is_that_of_version_3(folder):
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    assert files == [
        "data/chunk-000/file-000.parquet", "meta/episodes/chunk-000/file-000.parquet", "meta/info.json",
        "meta/stats.json", "meta/tasks.parquet", f"videos/{CAMERA}/chunk-000/file-000.mp4",
    ]  # fmt: skip
    info = json.loads((folder / "meta/info.json").read_text("utf-8"))
    assert info["codebase_version"] == "v3.0"
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (2, 3, 2)


def test_every_fold_is_a_frame_with_its_picks_and_places(folder, episodes):
    rows = pq.read_table(folder / "data/chunk-000/file-000.parquet").to_pylist()
    steps = [step for episode in episodes for step in episode.final_attempts()]
    assert [row["episode_index"] for row in rows] == [0, 1, 1]
    assert [row["frame_index"] for row in rows] == [0, 0, 1]
    for row, step in zip(rows, steps, strict=True):
        action = as_action(row["action"], step.observation.camera)
        np.testing.assert_allclose(action.picks, step.action.picks, atol=1e-3)
        np.testing.assert_allclose(action.places, step.action.places, atol=1e-3)
    assert rows[0]["observation.state"] == [0.0] * 4
    assert rows[2]["observation.state"] == pytest.approx(np.reshape(rows[1]["action"], (2, 2, 2))[:, 1].reshape(4))


def test_the_video_shows_what_was_seen_before_each_fold(folder, episodes):
    with av.open(str(folder / f"videos/{CAMERA}/chunk-000/file-000.mp4")) as video:
        seen = [(frame.time, frame.to_ndarray(format="rgb24")) for frame in video.decode(video=0)]
    steps = [step for episode in episodes for step in episode.final_attempts()]
    assert [time for time, _ in seen] == [0.0, 1.0, 2.0]
    for (_, picture), step in zip(seen, steps, strict=True):
        assert np.abs(picture.astype(int) - step.observation.rgb).mean() < 3.0


def test_episodes_say_where_their_frames_are(folder):
    rows = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["dataset_from_index"], row["dataset_to_index"]) for row in rows] == [(0, 1), (1, 3)]
    assert [row[f"videos/{CAMERA}/from_timestamp"] for row in rows] == [0.0, 1.0]
    assert rows[0]["tasks"] == ["fold it in half"]
    stats = json.loads((folder / "meta/stats.json").read_text("utf-8"))
    assert np.shape(stats[CAMERA]["mean"]) == (3, 1, 1)
    assert len(stats["action"]["std"]) == 8


def test_lerobot_reads_it(folder, episodes):
    datasets = pytest.importorskip("lerobot.datasets.lerobot_dataset", reason="reads it")
    found = datasets.LeRobotDataset("mine", root=folder)
    assert len(found) == 3
    item = found[2]
    assert item["task"] == "fold the top edge to the bottom edge"
    assert tuple(item[CAMERA].shape) == (3, 400, 400)
    assert tuple(item["action"].shape) == (8,)


def test_what_cannot_be_exported_says_so(folder, episodes, tmp_path):
    with pytest.raises(ConfigError, match="holds something already"):
        write_dataset(episodes, folder)
    with pytest.raises(ConfigError, match="fold something first"):
        write_dataset([], tmp_path / "none")
    with pytest.raises(ConfigError, match="nothing was folded"):
        Recording.of(polyfold.fold("fold it in half", episodes[0].garment, agent="noop"))


def test_the_verb_folds_tasks_and_goes_on_where_it_was_stopped(tmp_path, monkeypatch, capsys):
    out = tmp_path / "data"
    arguments = [
        "export", "--out", str(out), "--tasks", "square-triangle-top_left", "--garments", "2", "--edge-length", "0.03",
    ]  # fmt: skip
    from polyfold_interchange import command

    whole, folded = command.recorded, []

    def stopped(*given):
        folded.append(given[-1])
        if len(folded) == 2:
            raise KeyboardInterrupt
        return whole(*given)

    monkeypatch.setattr(command, "recorded", stopped)
    assert main(arguments) == 130
    assert not out.exists()
    assert main(arguments) == 0
    assert folded == [("square-triangle-top_left", 1000), *[("square-triangle-top_left", 1001)] * 2]
    assert "2 of 2 episodes" in capsys.readouterr().out
    assert not list(tmp_path.glob("data.parts*"))
    assert main(arguments) == 0, "what is finished stays so"
    assert "2 of 2 episodes" in capsys.readouterr().out
    assert len(folded) == 3
    assert main([*arguments, "--first-seed", "1005"]) != 0
    assert "holds something else already" in capsys.readouterr().err
    assert main(["export", "--out", str(tmp_path / "x"), "--tasks", "square-triangl"]) != 0
    assert "did you mean" in capsys.readouterr().err


def test_tasks_are_chosen_by_patterns_and_goals_have_no_folds_to_show():
    from polyfold_interchange.command import _jobs

    jobs = _jobs("polyfold70", "seen", ["square-corner-*_left"], 1000, 2)
    assert {name for name, _ in jobs} == {"square-corner-bottom_left", "square-corner-top_left"}
    assert len(jobs) == 4
    with pytest.raises(ConfigError, match="leaves its folds open"):
        _jobs("ambiguous", "seen", ["*"], 1000, 1)
