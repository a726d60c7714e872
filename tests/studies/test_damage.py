"""Folders of runs that were damaged, shared or given away: nothing lost, nothing doubled."""

import json
import subprocess
import sys

import pytest

import polyfold
from polyfold.errors import ConfigError
from polyfold.logs import exclusive

TINY = {"name": "tiny", "tasks": ("square-corner-*",), "first_seed": 2000, "edge_length": 0.03}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))


def study(**settings):
    return polyfold.Study(**{**TINY, **settings}, base={"agent": "noop"})


def lines_of(folder):
    return (folder / "episodes.jsonl").read_bytes().splitlines(keepends=True)


def test_one_flipped_byte_costs_one_episode_and_that_runs_again(tmp_path):
    whole = [record.key for record in polyfold.run(study(), tmp_path, progress=False).records]
    lines = lines_of(tmp_path)
    (tmp_path / "episodes.jsonl").write_bytes(b"".join([lines[0], b"\xff" + lines[1][1:], *lines[2:]]))
    with pytest.warns(UserWarning, match="line 2 is not JSON.*run the evaluation again"):
        left = polyfold.open(tmp_path)
    assert len(left.records) == len(whole) - 1
    with pytest.warns(UserWarning, match="set aside"):
        again = polyfold.run(study(), tmp_path, progress=False)
    assert [record.key for record in again.records] == whole
    assert len(lines_of(tmp_path)) == len(whole)


def test_episodes_that_stand_twice_count_once(tmp_path):
    whole = polyfold.run(study(), tmp_path, progress=False).records
    (tmp_path / "episodes.jsonl").write_bytes(b"".join(2 * lines_of(tmp_path)))
    assert len(polyfold.open(tmp_path).records) == len(whole)


def test_a_directory_in_use_is_refused_and_nothing_is_doubled(tmp_path):
    with exclusive(tmp_path), pytest.raises(ConfigError, match="is in use by process"):
        polyfold.run(study(), tmp_path, progress=False)
    assert not (tmp_path / "episodes.jsonl").exists()


def test_processes_racing_on_one_directory_leave_each_episode_once(tmp_path):
    config = tmp_path / "study.toml"
    config.write_text('tasks = ["square-corner-*"]\nfirst_seed = 2000\nedge_length = 0.03\nbase = { agent = "noop" }\n')
    out = tmp_path / "run"
    command = [sys.executable, "-m", "polyfold", "evaluate", str(config), "--out", str(out)]
    racing = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(2)]
    said = [(child.communicate()[1].decode(), child.returncode) for child in racing]
    for error, status in said:
        assert status == 0 or "is in use by process" in error
    assert any(status == 0 for _, status in said)
    keys = [json.loads(line)["key"] for line in lines_of(out)]
    assert len(keys) == len(set(keys)) == 4


@pytest.mark.parametrize(
    "wrong", [{"tasks": ()}, {"tasks": ("nothing-*",)}, {"suite": "no-such"}], ids=["no task", "unknown", "no suite"]
)
def test_a_study_that_cannot_run_leaves_no_run_behind(tmp_path, wrong):
    with pytest.raises(polyfold.errors.PolyfoldError):
        polyfold.run(study(**wrong), tmp_path / "run", progress=False)
    assert not (tmp_path / "run").exists()


def test_dask_that_is_missing_leaves_no_run_behind(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match="pip install distributed"):
        polyfold.run(study(), tmp_path / "run", engine="dask", progress=False)
    assert not (tmp_path / "run").exists()
