"""JSON lines survive kills at any byte, several writers, and text of every kind."""

import subprocess
import sys

import pytest

from polyfold.errors import ConfigError
from polyfold.logs import JsonLines

RECORDS = [{"n": 1, "text": "fold"}, {"n": 2, "text": "ö \u2028 \ud800"}, {"n": 3, "text": "x" * 100_000}]


@pytest.fixture
def lines(tmp_path):
    lines = JsonLines(tmp_path / "deep" / "log.jsonl")
    for record in RECORDS:
        lines.append(record)
    return lines


def test_what_was_added_is_read(lines):
    assert lines.read() == RECORDS
    assert lines.path.read_text("utf-8").count("\n") == len(RECORDS)


def test_where_files_can_not_be_locked_another_one_is(tmp_path, monkeypatch):
    """As on Windows, which has no flock."""
    from concurrent.futures import ThreadPoolExecutor

    monkeypatch.setattr("polyfold.logs._disk.json_lines.fcntl", None)
    path = tmp_path / "log.jsonl"
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda number: JsonLines(path).append({"n": number, "text": "x" * 10_000}), range(40)))
    assert sorted(record["n"] for record in JsonLines(path).read()) == list(range(40))


def test_no_file_holds_nothing(tmp_path):
    lines = JsonLines(tmp_path / "none.jsonl")
    lines.repair()
    assert lines.read() == []


@pytest.mark.parametrize("kept", [0, 1, 30, 31, 70_000, -2, -1])
def test_a_line_cut_in_half_anywhere_is_left_out_and_removed(lines, kept):
    whole = lines.path.read_bytes()
    cut = whole[:kept]
    lines.path.write_bytes(cut)
    complete = cut[: cut.rfind(b"\n") + 1]
    found = RECORDS[: complete.count(b"\n")]
    assert lines.read() == found
    lines.repair()
    assert lines.path.read_bytes() == complete
    lines.path.write_bytes(cut)
    lines.append({"n": 4})
    assert lines.read() == [*found, {"n": 4}]


def test_a_reader_goes_on_where_it_stopped(lines):
    first, end = next(lines.lines())
    assert b'"n": 1' in first
    assert [line for line, _ in lines.lines(end)] == [line for line, _ in lines.lines()][1:]


def test_a_finished_file_needs_no_last_end_of_line(tmp_path):
    path = tmp_path / "foreign.jsonl"
    path.write_text('{"n": 1}\n\n{"n": 2}')
    assert [line for line, _ in JsonLines(path).lines(growing=False)] == [b'{"n": 1}\n', b'{"n": 2}']


@pytest.mark.parametrize("line", ["{", "[1]", "[" * 100_000, "\udcff"])
def test_a_broken_line_is_named(lines, line):
    with lines.path.open("ab") as file:
        file.write(line.encode("utf-8", "surrogateescape") + b"\n")
    with pytest.raises(ConfigError, match=r"log.jsonl, line 4 .*remove the line"):
        lines.read()


def test_long_lines_are_refused_both_ways(lines):
    short = JsonLines(lines.path, longest=1000)
    with pytest.raises(ConfigError, match="more than 1000 bytes; remove it"):
        short.read()
    with pytest.raises(ConfigError, match="too long"):
        short.append({"text": "x" * 1000})
    assert lines.read() == RECORDS


def test_a_path_that_can_not_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match=r"can't write .*choose another path"):
        JsonLines(tmp_path / "file" / "log.jsonl").append({})


def test_processes_append_at_once(tmp_path):
    path = tmp_path / "log.jsonl"
    program = (
        "import sys; from polyfold.logs import JsonLines\n"
        "for n in range(50): JsonLines(sys.argv[1]).append({'who': sys.argv[2], 'n': n, 'text': 'x' * 5000})"
    )
    children = [subprocess.Popen([sys.executable, "-c", program, str(path), who]) for who in "abc"]
    assert [child.wait(60) for child in children] == [0, 0, 0]
    found = JsonLines(path).read()
    assert [[record["n"] for record in found if record["who"] == who] for who in "abc"] == [list(range(50))] * 3
