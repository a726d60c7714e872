"""Word pieces of a sentence, with the garment's kind in front."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from polyfold_offline.reading.text import Corrector

if TYPE_CHECKING:
    from tokenizers import Tokenizer

MAX_PIECES = 192

_KINDS = {
    "square": "square cloth",
    "rectangle": "rectangle towel",
    "tshirt": "shirt",
    "pants": "pants",
}
_MARKS = {f"#{number}": f"[unused{number}]" for number in range(1, 9)}


class Pieces:
    """Sentence to word pieces, by MiniLM's vocabulary."""

    def __init__(self, tokenizer: Tokenizer, words: dict[str, int]) -> None:
        """Args:
        tokenizer: of the encoder.
        words: words of folding -> how often they are said, which misspelt ones are brought back to.
        """
        self._tokenizer = tokenizer
        known = (word for word in tokenizer.get_vocab() if word.isalpha())
        self._corrector = Corrector(frozenset(known), words)

    @classmethod
    def load(cls, folder: Path) -> Pieces:
        """Read ``pieces.json`` (a tokenizer) and ``words.json``."""
        from tokenizers import Tokenizer

        tokenizer = Tokenizer.from_file(str(folder / "pieces.json"))
        tokenizer.no_padding()
        tokenizer.no_truncation()
        return cls(tokenizer, json.loads((folder / "words.json").read_text(encoding="utf-8")))

    @property
    def vocabulary(self) -> int:
        """How many pieces there are."""
        return self._tokenizer.get_vocab_size()

    def read(self, text: str, family: str) -> list[int]:
        """The pieces of a sentence in which lengths are marked (see :func:`take_lengths`)."""
        text = self._corrector.correct(text)
        for mark, piece in _MARKS.items():
            text = text.replace(mark, piece)
        return self._tokenizer.encode(_KINDS.get(family, "garment"), text).ids[:MAX_PIECES]
