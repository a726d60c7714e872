"""Sentences as the network sees them: lengths taken out, misspelt words brought back to those of folding."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from polyfold_offline.reading.numbers import AMOUNT, UNITS, number_of, with_last_numbers, with_plain_shares

MAX_CHARACTERS = 1500
"""Longer sentences are cut; no request is."""

_CM = {"mm": 0.1, "millimet": 0.1, "milimet": 0.1, "cm": 1.0, "centimet": 1.0, "m": 100.0, "met": 100.0, "inch": 2.54}
_UNIT = rf"(?P<unit>{UNITS})"
_LENGTH = re.compile(
    rf"(?P<first>{AMOUNT})\s*-?\s*(?:(?:x|×|by|\*)\s*(?P<second>{AMOUNT})\s*-?\s*)?{_UNIT}(?![\w])", re.IGNORECASE
)
_PAIR = re.compile(r"(?<![\w.,/])(?P<first>\d{2,3})\s*(?:x|×|by)\s*(?P<second>\d{2,3})(?![\w/])", re.IGNORECASE)
_WORD = re.compile(r"[^\W\d_]+(?:'[^\W\d_]+)?")


@dataclass(frozen=True)
class Read:
    """A sentence with marks ``#1``, ``#2`` for the lengths in it, and these: [cm], or shares of the garment's side."""

    text: str
    lengths: tuple[float | Fraction, ...]


def take_lengths(sentence: str) -> Read:
    """Put marks in the place of lengths with a unit, and of sizes such as ``20 x 30``."""
    lengths: list[float | Fraction] = []

    def mark(match: re.Match[str]) -> str:
        unit = match.groupdict().get("unit") or "cm"
        scale = next(
            factor for name, factor in sorted(_CM.items(), key=lambda it: -len(it[0])) if unit.lower().startswith(name)
        )
        said = [match[name] for name in ("first", "second") if match[name]]
        marks = []
        for amount in said:
            lengths.append(number_of(amount) * scale)
            marks.append(f"#{len(lengths)}")
        return f" {' by '.join(marks)} cm"

    def marked(share: Fraction) -> str:
        lengths.append(share)
        return f"#{len(lengths)} cm"

    text = unicodedata.normalize("NFKC", sentence)[:MAX_CHARACTERS]
    text = with_last_numbers(text.replace("’", "'").replace("⁄", "/"))
    text = with_plain_shares(_PAIR.sub(mark, _LENGTH.sub(mark, text)), marked)
    return Read(" ".join(text.split()), tuple(lengths))


class Corrector:
    """Brings misspelt words back to words of folding; words of the dictionary stay as they are."""

    def __init__(self, dictionary: Collection[str], words: Mapping[str, int]) -> None:
        """Args:
        dictionary: words that are spelled right.
        words: words of folding -> how often they are said; only these are put in the place of others.
        """
        self._dictionary = frozenset(dictionary) | set(words)
        self._words = dict(words)
        self._known: dict[str, str] = {}

    @cached_property
    def _by_sound(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for word in self._words:
            found.setdefault(_sound(word), []).append(word)
        return found

    def correct(self, text: str) -> str:
        """The text with its unknown words replaced."""
        return _WORD.sub(lambda match: self._corrected(match[0]), text)

    def _corrected(self, word: str) -> str:
        low = word.lower()
        if low in self._dictionary or len(low) < 3:
            return word
        if low not in self._known:
            self._known[low] = self._nearest(low) or low
        near = self._known[low]
        return word if near == low else near

    def _nearest(self, word: str) -> str | None:
        if (stem := re.sub(r"('s|'|s|ed|ing|er)$", "", word)) != word and stem in self._dictionary:
            return None
        limit = 1 if len(word) < 6 else 2
        near = [(distance, other) for other in self._words if (distance := _edits(word, other, limit)) <= limit]
        alike = [(0.8 + 0.3 * _edits(word, other, 4), other) for other in self._by_sound.get(_sound(word), ())]
        cut_short = [(0.9, other) for other in self._words if other.startswith(word)]
        found = [*near, *cut_short, *((distance, other) for distance, other in alike if distance < 2.4)]
        return min(found, key=lambda it: (it[0], -self._words[it[1]]))[1] if found else None


def _sound(word: str) -> str:
    """A key that words spelled by ear share."""
    for pattern, by in _SOUNDS:
        word = pattern.sub(by, word)
    return word


_SOUNDS = [
    (re.compile(pattern), by)
    for pattern, by in (
        ("^kn", "n"), ("^wr", "r"), ("ph", "f"), ("ght", "t"), ("gh", ""), ("ck", "k"), ("c(?=[eiy])", "s"),
        ("[cq]", "k"), ("x", "ks"), ("z", "s"), ("v", "f"), ("lf", "f"), ("ed$", "d"), ("(?<=.)[aeiouyhw]+", ""),
        ("^[aeiou]+", "a"), (r"(.)\1+", r"\1"),
    )
]  # fmt: skip


def _edits(a: str, b: str, limit: int) -> int:
    """Insertions, deletions, replacements and swaps of neighbours between two words; above ``limit`` only a bound."""
    if abs(len(a) - len(b)) > limit:
        return limit + 1
    before, last = [], list(range(len(b) + 1))
    for i, letter in enumerate(a, 1):
        row = [i]
        for j, other in enumerate(b, 1):
            cost = min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == b[j - 2] and a[i - 2] == other:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        if min(row) > limit:
            return limit + 1
        before, last = last, row
    return last[-1]


def words_of(text: str) -> list[str]:
    """The words of a text, in small letters."""
    return [match[0].lower() for match in _WORD.finditer(text)]
