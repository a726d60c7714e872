"""The words of folding, read from ``lexicon.txt``."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

Phrase = tuple[tuple[str, ...], str, str]
"""The words, their category and their value."""


@cache
def _parts() -> tuple[str, str]:
    text = files("polyfold_rules.words").joinpath("lexicon.txt").read_text("utf-8")
    table, _, filler = text.partition("\nfiller:\n")
    return table, filler


@cache
def fillers() -> frozenset[str]:
    """Words that say nothing about a fold."""
    return frozenset(_parts()[1].split())


@cache
def phrases() -> dict[str, list[Phrase]]:
    """First word -> phrases that start with it, longest first."""
    table: dict[str, list[Phrase]] = {}
    for line in _parts()[0].splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        head, _, rest = line.partition(":")
        category, _, value = head.partition(" ")
        for phrase in rest.split(","):
            words = tuple(phrase.split())
            if words:
                table.setdefault(words[0], []).append((words, category, value))
    for entries in table.values():
        entries.sort(key=lambda entry: -len(entry[0]))
    return table
