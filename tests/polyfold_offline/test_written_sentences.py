"""The sentences to learn from: well-formed, apart by use, and none of those that the reader is measured on."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

from experiments.benchmarks.language.registers import SENTENCES, accepted_lines, read_sentences
from polyfold.tasks import load_suite

SETS = Path(__file__).parent
REGISTERS = tomllib.loads((SENTENCES.parent / "registers.toml").read_text("utf-8"))["register"]
NEWCOMERS = SENTENCES.parent / "newcomers"
USES = ("train", "dev", "final")


def plain(text: str) -> str:
    return " ".join(re.findall(r"[a-z0-9]+", text.lower()))


def measured_on() -> set[str]:
    """Texts that only measure: suites, and sets that were held out."""
    suite = load_suite("polyfold_standard:tasks/polyfold70.toml")
    found = {sentence for task in suite.tasks for sentence in task.instructions}
    ambiguous = tomllib.loads(files("polyfold_standard").joinpath("tasks/ambiguous.toml").read_text("utf-8"))
    found |= {goal["text"] for goal in ambiguous["goal"]}
    found |= {goal["text"] for goal in tomllib.loads((SETS / "wishes.toml").read_text("utf-8"))["goal"]}
    for name, only_held_out in (("instructions", False), ("sentences", True)):
        content = tomllib.loads((SETS / f"{name}.toml").read_text("utf-8"))
        entries = [*content["instruction"], *content["refuse"]]
        found |= {entry["text"] for entry in entries if entry.get("held_out", False) or not only_held_out}
    return {plain(text) for text in found}


def test_registers_are_apart_by_use():
    assert len({register["name"] for register in REGISTERS}) == len(REGISTERS) >= 90
    for use in ("dev", "final"):
        assert sum(register["use"] == use for register in REGISTERS) == 20
    used = {f"{register['number']:02}-{register['name']}": register["use"] for register in REGISTERS}
    for use in USES:
        for path in (SENTENCES / use).glob("*.jsonl"):
            assert used.get(path.stem, "train") == use, path


def test_no_sentence_that_measures_is_learned_from():
    learned = {plain(sentence.text) for sentence in read_sentences("train")}
    shared = {text for text in learned & measured_on() if len(text.split()) > 2}
    assert not shared
    assert not {plain(s.text) for use in ("dev", "final") for s in read_sentences(use) if len(s.text) > 30} & learned
    lines = [line for file in NEWCOMERS.glob("*.jsonl") for line in file.read_text("utf-8").splitlines()]
    newcomers = [json.loads(line)["text"] for line in lines]
    assert len(newcomers) == 479
    assert not {plain(text) for text in newcomers if len(text) > 30} & learned


@pytest.mark.parametrize("use", USES)
def test_every_meaning_can_be_carried_out_or_is_a_refusal(use):
    sentences = read_sentences(use)
    assert sentences
    meanings = {(sentence.garment, sentence.meaning) for sentence in sentences if not sentence.impossible}
    assert not [meaning for meaning in meanings if not accepted_lines(*meaning)]
