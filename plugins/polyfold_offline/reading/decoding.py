"""The likeliest programs of a sentence, by a beam that never leaves what the garment's table allows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold_offline.meaning.program import Program
from polyfold_offline.reading.network import Floats, Network
from polyfold_offline.reading.tokens import INDEX, MAX_TOKENS, State, advance, begin, choices

WIDTH = 6


@dataclass(frozen=True)
class Candidate:
    """A program and the logarithm of its probability."""

    program: Program
    score: float


def likeliest(network: Network, pieces: list[int], family: str, width: int = WIDTH) -> list[Candidate]:
    """At most ``width`` programs, the likeliest first."""
    sentence = network.read(pieces)
    states, scores = [begin(family)], np.zeros(1)
    last, past, ended = np.array([INDEX[f"family {family}"]]), None, []
    for _ in range(MAX_TOKENS):
        raw, past = network.spell(sentence, last, past)
        rows, tokens, reached = _best(states, scores, raw, width)
        kept = []
        for row, token, score in zip(rows, tokens, reached, strict=True):
            state = advance(states[row], int(token))
            if state.ended:
                ended.append(Candidate(state.pieces, float(score)))
            else:
                kept.append((row, token, score, state))
        worst = sorted((c.score for c in ended), reverse=True)[width - 1 : width]
        kept = [entry for entry in kept if not worst or entry[2] > worst[0]]
        if not kept:
            break
        chosen = [entry[0] for entry in kept]
        past = [(keys[chosen], values[chosen]) for keys, values in past]
        last, scores, states = np.array([e[1] for e in kept]), np.array([e[2] for e in kept]), [e[3] for e in kept]
    return sorted(ended, key=lambda candidate: -candidate.score)[:width]


_HOPELESS = 6.0
"""Programs whose probability is less than that of the best by this factor's exponential are not followed."""


def _best(
    states: list[State], scores: NDArray[np.float64], raw: Floats, width: int
) -> tuple[list[int], list[int], list[float]]:
    """The best continuations: rows, tokens and scores."""
    found: list[tuple[float, int, int]] = []
    for row, (state, score) in enumerate(zip(states, scores, strict=True)):
        open_ = np.array(choices(state))
        level = raw[row, open_].astype(np.float64)
        level -= level.max()
        level -= np.log(np.exp(level).sum())
        found += [(score + value, row, int(token)) for value, token in zip(level, open_, strict=True)]
    found.sort(key=lambda it: -it[0])
    found = [entry for entry in found[:width] if entry[0] > found[0][0] - _HOPELESS]
    return [row for _, row, _ in found], [token for _, _, token in found], [score for score, _, _ in found]
