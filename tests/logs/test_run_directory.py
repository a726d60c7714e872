import os
import signal
import subprocess
import sys
import time

import pytest

from polyfold.errors import ConfigError
from polyfold.logs import RunDirectory, read_run
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._records import KeyedRecord


class Score(KeyedRecord):
    score: float
    text: str = ""


WRITER = """
import sys
from polyfold.logs import KeyedRecord, RunDirectory
class Score(KeyedRecord):
    score: float
    text: str = ""
run = RunDirectory(sys.argv[1], {"suite": "x"}, Score)
done = set(run.records())
for number in range(100000):
    if str(number) not in done:
        run.append(Score(key=str(number), score=number, text="x" * 2000))
"""


def test_half_written_line_is_dropped_and_the_rest_kept(tmp_path):
    run = RunDirectory(tmp_path, {"a": 1}, Score)
    run.append(Score(key="one", score=0.5))
    with (tmp_path / "episodes.jsonl").open("a") as file:
        file.write('{"key": "two", "sco')
    again = RunDirectory(tmp_path, {"a": 1}, Score)
    assert list(again.records()) == ["one"]
    again.append(Score(key="two", score=0.6))
    assert [record.score for record in RunDirectory(tmp_path, {"a": 1}, Score).records().values()] == [0.5, 0.6]


def test_another_configuration_is_refused_with_the_difference(tmp_path):
    RunDirectory(tmp_path, {"policy": "caso", "n": 3}, Score).append(Score(key="one", score=0.5))
    with pytest.raises(ConfigError, match=r"policy: 'caso' there, 'farthest' here"):
        RunDirectory(tmp_path, {"policy": "farthest", "n": 3}, Score)


def test_a_run_that_never_had_an_episode_binds_nobody(tmp_path):
    RunDirectory(tmp_path, {"policy": "caso"}, Score)
    RunDirectory(tmp_path, {"policy": "farthest"}, Score).append(Score(key="one", score=0.5))
    assert read_run(tmp_path).asked == {"policy": "farthest"}


def test_unknown_schema_version_is_refused(tmp_path):
    RunDirectory(tmp_path, {}, Score)
    description = tmp_path / "run.json"
    description.write_text(description.read_text().replace('"schema_version": 2', '"schema_version": 99'))
    with pytest.raises(ConfigError, match="99"):
        RunDirectory(tmp_path, {}, Score)


def test_survives_sigkill_and_resumes_without_loss_or_repetition(tmp_path):
    for _ in range(3):
        child = subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)])
        deadline = time.monotonic() + 30
        size = (tmp_path / "episodes.jsonl").stat().st_size if (tmp_path / "episodes.jsonl").exists() else 0
        while time.monotonic() < deadline:
            grown = (tmp_path / "episodes.jsonl").exists() and (
                tmp_path / "episodes.jsonl"
            ).stat().st_size > size + 9000
            if grown:
                break
            time.sleep(0.005)
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
    keys = [int(key) for key in RunDirectory(tmp_path, {"suite": "x"}, Score).records()]
    assert keys == list(range(len(keys)))
    assert len(keys) > 10


BEFORE = Fingerprint(
    distributions={"my-plugin": "0.1.0"}, sources={"my_plugin": "a" * 64}, prompts={"subgoals@v1": "b" * 64}
)
AFTER = Fingerprint(
    distributions={"my-plugin": "0.2.0"}, sources={"my_plugin": "c" * 64}, prompts={"subgoals@v1": "b" * 64}
)


def test_what_other_code_made_is_not_added_to(tmp_path):
    run = RunDirectory(tmp_path, {}, Score, BEFORE)
    run.guard()
    run.append(Score(key="one", score=1.0))
    again = RunDirectory(tmp_path, {}, Score, AFTER)
    with pytest.raises(ConfigError, match=r"version of my-plugin: 0\.1\.0 then, 0\.2\.0 now.*--accept-change"):
        again.guard()
    again.guard(accept_change=True)
    (change,) = read_run(tmp_path).changes
    assert change.episodes == 1
    assert "source of my_plugin: aaaaaaaaaaaa then, cccccccccccc now" in change.differences
    RunDirectory(tmp_path, {}, Score, AFTER).guard()
    with pytest.raises(ConfigError, match="my-plugin"):
        RunDirectory(tmp_path, {}, Score, BEFORE).guard()


def test_a_run_without_an_episode_takes_what_there_is_now(tmp_path):
    RunDirectory(tmp_path, {}, Score, BEFORE)
    run = RunDirectory(tmp_path, {}, Score, AFTER)
    run.guard()
    assert read_run(tmp_path).fingerprint == AFTER
    assert read_run(tmp_path).changes == ()


def damaged(path, number):
    """Flip a byte of a line of a file."""
    lines = path.read_bytes().splitlines(keepends=True)
    lines[number] = b"\xff" + lines[number][1:]
    path.write_bytes(b"".join(lines))


def test_a_damaged_line_is_set_aside_and_its_episode_missing(tmp_path):
    run = RunDirectory(tmp_path, {"a": 1}, Score)
    for key in ("one", "two", "three"):
        run.append(Score(key=key, score=1.0))
    damaged(tmp_path / "episodes.jsonl", 1)
    with (tmp_path / "episodes.jsonl").open("a") as file:
        file.write('{"key": "four", "score": "many"}\n')
    with pytest.warns(UserWarning, match=r"line 2 is not JSON.*and 1 more.*episodes\.damaged\.jsonl"):
        again = RunDirectory(tmp_path, {"a": 1}, Score)
    assert list(again.records()) == ["one", "three"]
    assert (tmp_path / "episodes.damaged.jsonl").read_bytes().count(b"\n") == 2
    again.append(Score(key="two", score=2.0))
    assert list(RunDirectory(tmp_path, {"a": 1}, Score).records()) == ["one", "three", "two"]


def test_a_damaged_description_says_how_to_go_on(tmp_path):
    RunDirectory(tmp_path, {"a": 1}, Score).append(Score(key="one", score=1.0))
    damaged(tmp_path / "run.json", 0)
    with pytest.raises(ConfigError, match=r"run\.json is not JSON.*--accept-change"):
        RunDirectory(tmp_path, {"a": 1}, Score)
    with pytest.raises(ConfigError, match=r"run\.json is not JSON.*--accept-change"):
        read_run(tmp_path)
    with pytest.warns(UserWarning, match=r"run\.damaged\.json"):
        again = RunDirectory(tmp_path, {"a": 1}, Score, redescribe=True)
    assert list(again.records()) == ["one"]
    (change,) = read_run(tmp_path).changes
    assert "damaged" in change.differences[0]
    assert (tmp_path / "run.damaged.json").read_bytes().startswith(b"\xff")


def test_episodes_without_a_description_are_not_taken_over(tmp_path):
    RunDirectory(tmp_path, {"a": 1}, Score).append(Score(key="one", score=1.0))
    (tmp_path / "run.json").unlink()
    with pytest.raises(ConfigError, match=r"put run\.json back"):
        RunDirectory(tmp_path, {"a": 1}, Score)
    assert not (tmp_path / "run.json").exists()
