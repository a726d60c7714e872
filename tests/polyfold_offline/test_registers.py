"""Judging written sentences: right, another fold, or refused."""

from __future__ import annotations

import pytest

from experiments.benchmarks.language import registers
from experiments.benchmarks.language.registers import Sentence, Verdict, judge, main, table, ways
from polyfold.plugins import create
from polyfold.types import Reply

LEFT_OVER = "fold the left edge rightward to the right edge along the vertical centre line"


class Refusing:
    def complete(self, messages, params):
        return Reply('```json\n{"refused": "no"}\n```')


@pytest.mark.parametrize(
    ("meaning", "result"),
    [
        ("half L", "right"), ("half side", "right"), ("half any", "right"), ("half R", "another fold"),
        ("half L; half B", "another fold"), ("mid L", "another fold"), ("goal half", "right"),
        ("goal triangle", "another fold"), ("no action", "another fold"),
    ],
)  # fmt: skip
def test_what_is_folded_is_compared_with_what_was_meant(meaning, result):
    sentence = Sentence("x", "square", meaning, LEFT_OVER)
    assert judge(sentence, create("planners", "hierarchical"), create("llms", "offline")).result == result


@pytest.mark.parametrize(("meaning", "result"), [("half L", "refused"), ("no part", "right")])
def test_a_refusal_is_right_where_nothing_can_be_done(meaning, result):
    sentence = Sentence("x", "square", meaning, "Do it.")
    verdict = judge(sentence, create("planners", "hierarchical"), Refusing())
    assert (verdict.result, verdict.detail) == (result, "no")


def test_what_is_left_open_can_be_settled_in_any_way():
    assert len(ways("square", "centre any")) == 5  # the default, and each corner
    assert {tuple(fold.manner for fold in way) for way in ways("tshirt", "sleeve any any; half B")} == {
        ("straight", ""),
        ("slanted", ""),
    }
    assert ways("pants", "no part") == []


def test_the_table_counts_what_is_to_be_folded_apart_from_what_is_not():
    fold, never = Sentence("a", "square", "half L", "x"), Sentence("b", "square", "no part", "y")
    results = ((fold, "right"), (fold, "refused"), (never, "right"))
    said = table([Verdict(sentence, result, "", 1.0) for sentence, result in results])
    assert "| a | 2 | 50.0 | 0.0 | 50.0 | 0 |" in said
    assert "| all 2 | 2 | 50.0 [" in said


def test_the_command_prints_table_and_curve(monkeypatch, capsys, tmp_path):
    sentences = [
        Sentence("a", "square", "half L", LEFT_OVER),
        Sentence("a", "square", "no part", "Fold the third leg."),
    ]
    monkeypatch.setattr(registers, "read_sentences", lambda use: sentences)
    assert main(["--brief"]) == 0
    assert "| a | 1 | 100.0 |" in capsys.readouterr().out
    assert main(["--curve", "--picture", str(tmp_path / "curve.png")]) == 0
    assert "| 0.6 | 100.0 | 0.0 | 0.0 |" in capsys.readouterr().out
    assert (tmp_path / "curve.png").stat().st_size > 1000
