import os
import signal
import subprocess
import sys
import time

import pytest

from polyfold.errors import ConfigError
from polyfold.logs import RunDirectory

WRITER = """
import sys
from polyfold.logs import RunDirectory
run = RunDirectory(sys.argv[1], {"suite": "x"})
done = set(run.episodes())
for number in range(100000):
    if str(number) not in done:
        run.append(str(number), {"score": number, "text": "x" * 2000})
"""


def test_half_written_line_is_dropped_and_the_rest_kept(tmp_path):
    run = RunDirectory(tmp_path, {"a": 1})
    run.append("one", {"score": 0.5})
    with (tmp_path / "episodes.jsonl").open("a") as file:
        file.write('{"key": "two", "sco')
    again = RunDirectory(tmp_path, {"a": 1})
    assert list(again.episodes()) == ["one"]
    again.append("two", {"score": 0.6})
    assert [record["score"] for record in RunDirectory(tmp_path, {"a": 1}).episodes().values()] == [0.5, 0.6]


def test_another_configuration_is_refused_with_the_difference(tmp_path):
    RunDirectory(tmp_path, {"policy": "caso", "n": 3})
    with pytest.raises(ConfigError, match=r"policy: 'caso' there, 'farthest' here"):
        RunDirectory(tmp_path, {"policy": "farthest", "n": 3})


def test_unknown_schema_version_is_refused(tmp_path):
    RunDirectory(tmp_path, {})
    description = tmp_path / "run.json"
    description.write_text(description.read_text().replace('"schema_version": 1', '"schema_version": 99'))
    with pytest.raises(ConfigError, match="99"):
        RunDirectory(tmp_path, {})


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
    keys = [int(key) for key in RunDirectory(tmp_path, {"suite": "x"}).episodes()]
    assert keys == list(range(len(keys)))
    assert len(keys) > 10
