"""What a user can get wrong ends in one line that says what to do, and leaves nothing behind."""

import argparse
import subprocess
import sys
from pathlib import Path

import pytest

from polyfold.cli import _parser, main
from polyfold.cli._options.numbers import TYPES

NOT_WHOLE = ("-1", "nan", "1.5", "many", "9" * 30, "9" * 5000, "")
NO_SHARE = ("-0.1", "1.5", "nan", "half", "")
NO_LENGTH = ("0", "-0.01", "nan", "inf", "long", "")


def one_line(result, status):
    assert result.status == status, result
    assert result.err.startswith("polyfold")
    assert result.err.count("\n") == 1
    assert "Traceback" not in result.err
    assert "[Errno" not in result.err
    return result.err


def options_of(verb):
    """The options of a verb that take a value, those of its actions included: (flags before it, option)."""
    (verbs,) = [action for action in _parser([verb])._actions if isinstance(action, argparse._SubParsersAction)]
    return list(_options(verbs.choices[verb], (verb,)))


def _options(parser, before):
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                yield from _options(inner, (*before, name))
        elif action.option_strings and action.nargs != 0:
            yield before, action


VERBS = "fold ground garments tasks evaluate table report prompt plugins cassette collect train maps train-language"
NUMBERS = [
    (*before, option.option_strings[0])
    for verb in VERBS.split()
    for before, option in options_of(verb)
    if option.type in TYPES
]


def test_every_number_of_every_verb_is_checked_in_the_same_way():
    assert len(NUMBERS) >= 20
    for verb in VERBS.split():
        for _, option in options_of(verb):
            assert option.type not in (int, float), f"{verb} {option.option_strings}: use one of {', '.join(TYPES)}"


@pytest.mark.parametrize("number", NUMBERS, ids=" ".join)
def test_a_wrong_number_is_refused_with_what_is_wanted(polyfold, number):
    *before, option = number
    (action,) = [it for flags, it in options_of(before[0]) if [*flags, it.option_strings[0]] == [*before, option]]
    wrong = {"metres": NO_LENGTH, "share": NO_SHARE}.get(action.type, NOT_WHOLE)
    for text in wrong:
        said = one_line(polyfold(*before, f"{option}={text}"), 2)
        assert option in said
        assert "give" in said
        assert " --help)" in said


def test_without_a_verb_the_verbs_are_told(polyfold):
    result = polyfold()
    assert result.status == 0
    assert "fold a garment from a sentence" in result.out


def test_a_mistyped_verb_is_answered_with_the_nearest(polyfold):
    assert "did you mean 'fold'?" in one_line(polyfold("foldd", "it"), 2)


@pytest.fixture
def places(tmp_path):
    """Places where nothing can be read or written."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_bytes(b"\x00\xff{")
    return {"folder": tmp_path / "folder", "missing": tmp_path / "no" / "such", "below a file": tmp_path / "file" / "x"}


READ = [
    ("fold", "fold it", "--config"),
    ("fold", "fold it", "--mask"),
    ("fold", "fold it", "--outline"),
    ("fold", "fold it", "--image"),
    ("fold", "fold it", "--keypoints", "README.md", "--mesh"),
    ("ground", "--garment", "tshirt"),
    ("evaluate", "--out", "never-made"),
    ("table",),
    ("report",),
    ("cassette", "show"),
    ("cassette", "missing"),
    ("train", "--out", "never-made"),
    ("train-language", "--out", "never-made"),
]


@pytest.mark.parametrize("where", ["folder", "missing", "below a file"])
@pytest.mark.parametrize("arguments", READ, ids=" ".join)
def test_what_cannot_be_read_is_named(polyfold, places, arguments, where, monkeypatch):
    said = one_line(polyfold(*arguments, places[where]), 1)
    assert str(places[where]) in said
    assert len(said.partition(";")[2]) > 10


@pytest.mark.parametrize(
    "arguments",
    [
        ("fold", "fold it in half", "--garment", "square"),
        ("evaluate", "experiments/smoke.toml"),
        ("garments", "--garment", "square", "--count", "1"),
    ],
    ids=" ".join,
)
def test_what_cannot_be_written_is_named(polyfold, places, arguments):
    said = one_line(polyfold(*arguments, "--out", places["below a file"]), 1)
    assert str(places["below a file"].parent) in said


def test_bytes_that_are_no_text_are_not_folded(polyfold, tmp_path):
    said = one_line(polyfold("fold", "fold it in h\udce4lf", "--garment", "square", "--out", tmp_path / "out"), 1)
    assert "UTF-8" in said
    assert not (tmp_path / "out").exists()


def test_invisible_characters_are_left_out_and_said(polyfold):
    hidden = "fold it in half\u202e\x07"
    result = polyfold("fold", hidden, "--garment", "square", "--edge-length", "0.03", "--json")
    assert result.status == 0, result.err
    assert "2 invisible characters" in result.err
    assert '"instruction": "fold it in half "' in result.out


def test_a_full_disk_is_said_once():
    with Path("/dev/full").open("w") as full:
        child = subprocess.run([sys.executable, "-m", "polyfold", "tasks"], stdout=full, stderr=subprocess.PIPE)
    assert child.returncode == 1
    assert child.stderr.decode().count("\n") == 1
    assert b"check the disk" in child.stderr


def test_a_terminal_without_unicode_shows_escapes(tmp_path):
    child = subprocess.run(
        [sys.executable, "-m", "polyfold", "fold", "fold it in half \u2013 please", "--garment", "square",
         "--edge-length", "0.03"],
        capture_output=True, env={"PYTHONIOENCODING": "ascii", "PATH": "", "HOME": str(tmp_path)},
    )  # fmt: skip
    assert child.returncode == 0, child.stderr
    assert b"\\u2013" in child.stdout


def test_a_bug_stays_a_traceback(monkeypatch):
    from polyfold.cli import tasks

    def broken(arguments):
        raise ValueError("a bug")

    monkeypatch.setattr(tasks, "run", broken)
    with pytest.raises(ValueError, match="a bug"):
        main(["tasks"])
