"""Batches by the number of their step: the same on every run, wherever it was stopped before."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import TYPE_CHECKING

import torch

from polyfold_offline.reading.tokens import FAMILIES, INDEX, TOKENS, spell
from polyfold_offline.training.network import Batch
from polyfold_offline.training.variation import vary

if TYPE_CHECKING:
    from polyfold_offline.reading.pieces import Pieces
    from polyfold_offline.training.corpus import Example

_TOGETHER = 4
"""Steps whose sentences are drawn together and parted by their length, so that batches need little padding."""

_MASKED = 0.06
"""Share of word pieces that are hidden in half of the sentences."""


class Batches:
    """An endless row of batches of varied sentences."""

    def __init__(
        self, written: Sequence[Example], made: Sequence[Example], pieces: Pieces, size: int, seed: int
    ) -> None:
        """Args:
        written: sentences that are varied.
        made: sentences of a generator, taken as they are.
        pieces: how sentences are read.
        size: sentences in a batch.
        seed: of all choices.
        """
        self._written, self._made, self._pieces, self._size, self._seed = written, made, pieces, size, seed
        self._kept: tuple[int, list[tuple[list[int], Example]]] | None = None
        self._others = {family: [e for e in written if e.family == family] for family in FAMILIES}

    def __call__(self, step: int) -> Batch:
        """The batch of a step."""
        block, place = divmod(step, _TOGETHER)
        return collate(self._sorted(block)[place * self._size : (place + 1) * self._size])

    def _sorted(self, block: int) -> list[tuple[list[int], Example]]:
        """The sentences of a block, the shortest first; the last block is kept, since its steps follow each other."""
        if self._kept is None or self._kept[0] != block:
            drawn = self._drawn(Random(f"{self._seed} {block}"))
            self._kept = block, sorted(drawn, key=lambda it: len(it[0]))
        return self._kept[1]

    def _drawn(self, random: Random) -> list[tuple[list[int], Example]]:
        found = []
        while len(found) < self._size * _TOGETHER:
            if self._made and random.random() < MADE_SHARE:
                example = random.choice(self._made)
            else:
                example = vary(random.choice(self._written), self._others, random)
            ids = self._pieces.read(example.text, example.family)
            found.append((_hidden(ids, random), example))
        return found


MADE_SHARE = 0.15
"""Share of sentences that come from the generator."""

_MASK, _FIRST_WORD = 103, 999
"""Pieces of MiniLM's vocabulary: what hides another, and the last before the first that is text."""


def _hidden(ids: list[int], random: Random) -> list[int]:
    if random.random() < 0.5:
        return ids
    return [_MASK if piece > _FIRST_WORD and random.random() < _MASKED else piece for piece in ids]


def collate(examples: Sequence[tuple[list[int], Example]]) -> Batch:
    """Word pieces and examples, padded to the longest."""
    spelled = [spell(example.program, example.family) for _, example in examples]
    long, most = max(len(ids) for ids, _ in examples), max(len(told) for told in spelled)
    count = len(examples)
    pieces, seen = torch.zeros(count, long, dtype=torch.long), torch.zeros(count, long, dtype=torch.bool)
    tokens, counted = torch.zeros(count, most + 1, dtype=torch.long), torch.zeros(count, most, dtype=torch.bool)
    allowed = torch.ones(count, most, len(TOKENS), dtype=torch.bool)
    for row, ((ids, example), told) in enumerate(zip(examples, spelled, strict=True)):
        pieces[row, : len(ids)], seen[row, : len(ids)] = torch.tensor(ids), True
        tokens[row, 0] = INDEX[f"family {example.family}"]
        for place, (token, open_) in enumerate(told):
            tokens[row, place + 1], counted[row, place] = token, True
            allowed[row, place] = False
            allowed[row, place, list(open_)] = True
    return Batch(pieces, seen, tokens, allowed, counted)
