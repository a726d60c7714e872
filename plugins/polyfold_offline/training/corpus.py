"""Sentences with their meanings, from JSONL files: one register a file, ``{"garment", "meaning", "text"}`` a line."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from polyfold.errors import ConfigError
from polyfold_offline.meaning.program import Piece, Program, parse_program
from polyfold_offline.reading.text import take_lengths


@dataclass(frozen=True)
class Example:
    """A sentence and what it means.

    Attributes:
        family: of the garment that lies there.
        text: the sentence, lengths in it replaced by marks.
        program: what it means, with the same marks.
        register: its manner of speaking.
    """

    family: str
    text: str
    program: Program
    register: str


def read_corpus(folder: Path) -> list[Example]:
    """All sentences of a folder, in the order of files and lines.

    Sentences whose lengths can't be found again in their text are passed over.

    Raises:
        ConfigError: if a line is no sentence with a meaning, or the folder holds none; it names the file and line.
    """
    found = []
    for path in sorted(folder.glob("*.jsonl")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            try:
                entry = json.loads(line)
                example = make_example(entry["garment"], entry["text"], entry["meaning"], path.stem)
            except (ValueError, KeyError, TypeError) as error:
                raise ConfigError(f"{path}, line {number}, is no sentence with its meaning: {error}") from error
            if example is not None:
                found.append(example)
    if not found:
        raise ConfigError(
            f"{folder} holds no sentences (*.jsonl); give a folder such as experiments/language/sentences/train"
        )
    return found


def make_example(family: str, text: str, meaning: str, register: str) -> Example | None:
    """An example of a sentence with its written meaning; None if the text does not name the meaning's lengths."""
    program, lengths = parse_program(meaning)
    read = take_lengths(text)
    renamed = {}
    for number, length in enumerate(lengths, 1):
        same = [i for i, other in enumerate(read.lengths, 1) if abs(other - length) < 0.01]
        # What is said once may be meant twice: *8 cm at the top, and the same at the bottom*.
        at = [i for i in same if f"#{i}" not in renamed.values()] or same
        if not at or at[0] > 4:
            return None
        renamed[f"#{number}"] = f"#{at[0]}"
    return Example(family, read.text, rename(program, renamed), register)


def rename(program: Program, words: dict[str, str]) -> Program:
    """The program with places and details replaced."""
    return tuple(Piece(p.operation, words.get(p.place, p.place), words.get(p.detail, p.detail)) for p in program)
