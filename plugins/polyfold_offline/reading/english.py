"""Whether a sentence is in English, all that the reader learned; it would make some fold of any other."""

from __future__ import annotations

import unicodedata
from collections.abc import Collection

SHORT, TELLING = 3, 4
"""Letters: shorter words may be any language's; two as long as the other are more than telegram style."""
LITTLE_WORDS = {
    "le", "la", "les", "el", "los", "las", "lo", "il", "gli", "un", "une", "una", "uno", "um", "uma", "des", "del",
    "della", "du", "de", "en", "dans", "et", "pour", "por", "para", "sur", "sobre", "vers", "hacia", "au", "aux",
    "al", "ao", "na", "não", "das", "der", "den", "dem", "ein", "eine", "und", "mit", "auf", "zur", "zum", "nach",
    "het", "een", "op", "naar", "och", "på", "til", "og",
}  # fmt: skip
"""Of French, Spanish, Italian, Portuguese, German, Dutch and Nordic tongues, without those that English has, too."""


def is_english(sentence: str, known: Collection[str]) -> bool:
    """Whether it may be English, misspelt or in telegram style.

    It is not if a word is of another script, if there is neither a word nor a number, if of several words none is
    known, or if little words of another language are as many as those that are known.

    Args:
        sentence: as it was typed; correcting would make English words of any others.
        known: English words of folding.
    """
    words = "".join(sign if sign.isalpha() else " " for sign in sentence).lower().split()
    if not words:
        return any(sign.isdigit() for sign in sentence)
    if not any(map(_is_latin, words)) or not all(len(word) == 1 or _is_latin(word) for word in words):
        return False
    familiar = sum(word in known for word in words if len(word) >= SHORT)
    little = sum(word in LITTLE_WORDS for word in words)
    telling = sum(len(word) >= TELLING for word in words)
    if little > 1:
        return familiar > little
    return familiar > 0 or (telling < 2 and little == 0)


def _is_latin(word: str) -> bool:
    return all("LATIN" in unicodedata.name(sign, "") for sign in word)
