"""Word pieces of a sentence, with the garment's kind in front."""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Iterator, Mapping
from pathlib import Path

from polyfold_offline.reading.text import Corrector

MAX_PIECES = 192

_KINDS = {
    "square": "square cloth",
    "rectangle": "rectangle towel",
    "tshirt": "shirt",
    "pants": "pants",
}
_MARKS = {f"#{number}": f"[unused{number}]" for number in range(1, 9)}
_LONGEST = 100
"""Characters of a word beyond which it is unknown as a whole."""


class Pieces:
    """Sentence to word pieces, by MiniLM's vocabulary (uncased WordPiece, arXiv:1810.04805).

    Ours, since the package ``tokenizers`` brings 40 MB and a network client with it; a test compares the two.

    Attributes:
        words: of folding, in English.
    """

    def __init__(self, vocabulary: Mapping[str, int], words: dict[str, int]) -> None:
        """Args:
        vocabulary: piece -> number, of the encoder; pieces within a word begin with ``##``.
        words: words of folding -> how often they are said, which misspelt ones are brought back to.
        """
        self.words = frozenset(words)
        self._numbers = vocabulary
        self._corrector = Corrector(frozenset(word for word in vocabulary if word.isalpha()), words)

    @classmethod
    def load(cls, folder: Path) -> Pieces:
        """Read ``pieces.json`` (a tokenizer as Hugging Face stores it) and ``words.json``."""
        stored = json.loads((folder / "pieces.json").read_text(encoding="utf-8"))
        return cls(stored["model"]["vocab"], json.loads((folder / "words.json").read_text(encoding="utf-8")))

    @property
    def vocabulary(self) -> int:
        """How many pieces there are."""
        return len(self._numbers)

    def read(self, text: str, family: str) -> list[int]:
        """The pieces of a sentence in which lengths are marked (see :func:`take_lengths`)."""
        text = self._corrector.correct(text)
        for mark, piece in _MARKS.items():
            text = text.replace(mark, piece)
        begin, end = self._numbers["[CLS]"], self._numbers["[SEP]"]
        kind = self.spell(_KINDS.get(family, "garment"))
        return [begin, *kind, end, *self.spell(text), end][:MAX_PIECES]

    def spell(self, text: str) -> list[int]:
        """The pieces of any text: of each word the longest that it begins with, again and again."""
        return [number for word in _words(text) for number in self._pieces_of(word)]

    def _pieces_of(self, word: str) -> list[int]:
        unknown = [self._numbers["[UNK]"]]
        if len(word) > _LONGEST:
            return unknown
        found, begin = [], 0
        while begin < len(word):
            inside = "##" if begin else ""
            ends = range(len(word), begin, -1)
            end = next((end for end in ends if inside + word[begin:end] in self._numbers), None)
            if end is None:
                return unknown
            found.append(self._numbers[inside + word[begin:end]])
            begin = end
        return found


def _words(text: str) -> Iterator[str]:
    """Words in lower case without accents; each mark of punctuation and each Chinese character is one of its own."""
    cleaned = "".join(" " if sign.isspace() else sign for sign in text if sign.isspace() or _is_kept(sign))
    apart = "".join(f" {sign} " if _is_chinese(sign) else sign for sign in cleaned)
    bare = (sign for sign in unicodedata.normalize("NFD", apart) if unicodedata.category(sign) != "Mn")
    for part in "".join(bare).lower().split():
        word = ""
        for sign in part:
            if not _is_punctuation(sign):
                word += sign
                continue
            if word:
                yield word
            yield sign
            word = ""
        if word:
            yield word


def _is_kept(sign: str) -> bool:
    return sign != "\ufffd" and unicodedata.category(sign) not in ("Cc", "Cf", "Co", "Cs")


def _is_punctuation(sign: str) -> bool:
    return unicodedata.category(sign).startswith("P") or (sign.isascii() and not sign.isalnum() and sign.isprintable())


def _is_chinese(sign: str) -> bool:
    return any(first <= ord(sign) <= last for first, last in _CHINESE)


_CHINESE = (
    (0x4E00, 0x9FFF), (0x3400, 0x4DBF), (0x20000, 0x2A6DF), (0x2A700, 0x2B73F), (0x2B740, 0x2B81F), (0x2B920, 0x2CEAF),
    (0xF900, 0xFAFF), (0x2F800, 0x2FA1F),
)  # fmt: skip
"""Blocks of characters that are words, as BERT has them."""
