"""Words as written: grammatical forms, numbers, and misspellings within one edit of a known word."""

from __future__ import annotations

import re
import unicodedata
from functools import cache

from polyfold_rules.words.lexicon import fillers, phrases

NUMBERS = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9,
    "ten": 10, "dozen": 12, "twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "hundred": 100, "thousand": 1000,
}  # fmt: skip
MISSPELT = {
    "teh": "the",
    "hte": "the",
    "adn": "and",
    "nad": "and",
    "lfet": "left",
    "letf": "left",
    "tot": "to",
    "fo": "of",
    "bot": "both",
    "boht": "both",
    "flod": "fold",
    "foled": "fold",
    "hafl": "half",
    "haf": "half",
    "sleve": "sleeve",
    "rigt": "right",
    "rihgt": "right",
    "righ": "right",
    "botom": "bottom",
    "bottem": "bottom",
    "midle": "middle",
    "tshrit": "tshirt",
    "tshir": "tshirt",
    "leggs": "legs",
    "pans": "pants",
    "hemm": "hem",
    "conrer": "corner",
    "coner": "corner",
    "sqare": "square",
    "thrid": "third",
    "lef": "left",
    "ontop": "on top",
}
"""Short words and double slips that one edit on a long word does not reach."""
IRREGULAR = {
    "brought": "bring", "took": "take", "taken": "take", "laid": "lay", "swung": "swing", "sent": "send",
    "bent": "bend", "met": "meet", "kept": "keep", "left": "left", "made": "make", "drawn": "draw", "slid": "slide",
    "went": "go", "gone": "go", "came": "come", "goes": "go", "held": "hold", "lay": "lay", "lies": "lie",
    "lying": "lie", "sat": "sit", "hung": "hang", "worn": "wear", "tore": "tear", "torn": "tear", "spun": "spin",
    "shook": "shake", "threw": "throw", "thrown": "throw", "undid": "undo", "undone": "undo", "leaves": "leave",
    "tidied": "tidy", "tidies": "tidy", "halved": "halve", "halves": "half", "drew": "draw", "hid": "hide",
    "dries": "dry", "dried": "dry", "ran": "run", "shrunk": "shrink", "ft": "foot", "centres": "centre",
    "centers": "centre", "center": "centre", "middles": "middle", "organised": "organise",
}  # fmt: skip


def number_of(word: str) -> int | None:
    """The number that a word stands for, in digits or letters."""
    return int(word) if word.isdigit() and len(word) < 7 else NUMBERS.get(word)


def variants(word: str) -> tuple[tuple[str, str], ...]:
    """Possible dictionary forms of a word with its grammatical form."""
    found = [(word, "base")]
    if word in IRREGULAR:
        found.append((IRREGULAR[word], "plural" if word.endswith("s") else "past"))
    for ending, added, form in (
        ("s", "", "plural"), ("es", "", "plural"), ("ies", "y", "plural"), ("ing", "", "ing"), ("ing", "e", "ing"),
        ("ed", "", "past"), ("d", "", "past"), ("ied", "y", "past"), ("ves", "f", "plural"),
    ):  # fmt: skip
        if word.endswith(ending) and len(word) - len(ending) >= 2:
            stem = word[: -len(ending)]
            if ending == "d" and stem[-1] != "e":
                continue
            found.append((stem + added, form))
            if not added and len(stem) > 3 and stem[-1] == stem[-2]:
                found.append((stem[:-1], form))
    return tuple(found)


@cache
def _vocabulary() -> frozenset[str]:
    words = {word for entries in phrases().values() for phrase, _, _ in entries for word in phrase}
    return frozenset(words | set(fillers()) | set(NUMBERS) | set(IRREGULAR))


def _known(word: str) -> bool:
    return any(form in _vocabulary() for form, _ in variants(word))


def spell(word: str, corrections: list[tuple[str, str]]) -> str:
    """The word itself if known, else the one known word within a single edit; short words are left alone."""
    if word in MISSPELT and not _known(word):
        corrections.append((word, MISSPELT[word]))
        return MISSPELT[word]
    if len(word) < 4 or not word.isalpha() or _known(word) or word.startswith(("stepcount", "timescount")):
        return word
    shortest = 5 if len(word) > 4 else 4
    near = sorted(
        k
        for k in _vocabulary()
        if len(k) >= shortest and _one_edit(word, k, len(word) == 4) and (k[0] == word[0] or k[:2] == word[1::-1])
    )
    singular = word[:-1] if word.endswith("s") else ""
    if not near and len(singular) >= 5:
        near = sorted(
            k + "s" for k in _vocabulary() if len(k) >= 5 and k[0] == word[0] and _one_edit(singular, k, False)
        )
    if len(near) > 1:
        near = [known for known in near if known[0] == word[0] and len(known) == len(word)] or near
    if len(near) > 1:
        near = [known for known in near if known[-1] == word[-1]]
    if len(near) != 1:
        return word
    corrections.append((word, near[0]))
    return near[0]


def _one_edit(a: str, b: str, swaps_only: bool) -> bool:
    """Whether one insertion, deletion, substitution or swap of neighbours turns ``a`` into ``b``."""
    if abs(len(a) - len(b)) > 1:
        return False
    start = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    x, y = a[start:], b[start:]
    if len(x) > 1 and len(y) > 1 and x[0] == y[1] and x[1] == y[0] and x[2:] == y[2:]:
        return True
    return not swaps_only and (x[1:] == y[1:] or x[1:] == y or x == y[1:])


def plainest(text: str) -> str:
    """Lower-case words and stops, one blank between them; contractions are written out, hyphens are blanks."""
    text = unicodedata.normalize("NFKD", text.lower()).replace("\u2019", "'").replace("\u2018", "'")
    text = re.sub(r"can(?:no|')t\b", "can not", text)
    text = re.sub(r"n't\b", " not", re.sub(r"\bdont\b", "do not", text))
    text = re.sub(r"'(?:s|ve|ll|d|re|m)\b", "", text).replace("s' ", "s ")
    for said, word in (("1/2", "half"), ("50 ?%", "half"), ("1/3", "third"), ("1/4", "quarter"), ("25 ?%", "quarter")):
        text = re.sub(rf"(?<![\w/]){said}(?!\w)", word, text)
    for said, word in (
        ("1/8", "eighth"),
        ("1/6", "sixth"),
        ("1/9", "ninth"),
        ("2/3", "two thirds"),
        ("3/4", "three quarters"),
    ):
        text = re.sub(rf"(?<![\w/]){said}(?!\w)", word, text)
    text = re.sub(r"(?<=\d) ?(?:%|per ?cent)", " percent", text)
    text = re.sub(r"\bt-?shirt", "tshirt", text)
    return re.sub(r"\s+", " ", re.sub(r"[^a-z0-9',.;:!?]+", " ", text)).strip()
