"""Programs as sequences of tokens: only choices are spelled, the rest follows from the garment's table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from polyfold_offline.meaning.program import (
    DETAILS,
    OPERATIONS,
    PLACES,
    Piece,
    Program,
    details_of,
    operations_after,
    places_of,
)

FAMILIES = ("square", "rectangle", "tshirt", "pants", "other")
FAMILY_WORDS = {"square": "cloth", "rectangle": "cloth", "tshirt": "shirt", "pants": "pants", "other": "garment"}
"""What the reader calls a garment of a kind that it does not know, by its family."""

TOKENS = (
    *(f"family {name}" for name in FAMILIES),
    *(f"operation {name}" for name in OPERATIONS),
    *(f"place {name}" for name in PLACES),
    *(f"detail {name}" for name in DETAILS),
)
INDEX = {token: index for index, token in enumerate(TOKENS)}

MAX_TOKENS = 24


@dataclass(frozen=True)
class State:
    """A program that is being spelled.

    Attributes:
        family: the garment's family.
        pieces: what is complete.
        open: operation, or operation and place, of the piece that is begun.
        ended: whether the program is complete.
    """

    family: str
    pieces: Program = ()
    open: tuple[str, ...] = ()
    ended: bool = False


@cache
def choices(state: State) -> tuple[int, ...]:
    """Tokens that may come next; at least two, unless the program has ended."""
    return tuple(INDEX[f"{_SLOTS[len(state.open)]} {word}"] for word in _words(state))


_SLOTS = ("operation", "place", "detail")


def _words(state: State) -> tuple[str, ...]:
    if not state.open:
        return operations_after(state.family, state.pieces)
    if len(state.open) == 1:
        return places_of(state.family, state.open[0])
    return details_of(state.open[0], state.open[1])


def begin(family: str) -> State:
    """Nothing spelled yet."""
    return State(family)


@cache
def advance(state: State, token: int) -> State:
    """The state after a token, and after all that then leaves no choice."""
    state = _with(state, TOKENS[token].split(" ", 1)[1])
    while not state.ended and len(words := _words(state)) == 1:
        state = _with(state, words[0])
    return state


def _with(state: State, word: str) -> State:
    if not state.open and word == "end":
        return State(state.family, state.pieces, (), True)
    spelled = (*state.open, word)
    if len(spelled) < len(_SLOTS):
        return State(state.family, state.pieces, spelled)
    return State(state.family, (*state.pieces, Piece(spelled[0], spelled[1], spelled[2])))


def spell(program: Program, family: str) -> list[tuple[int, tuple[int, ...]]]:
    """The tokens of a program, each with those that were allowed in its place.

    Raises:
        ValueError: if the garment's table does not allow it.
    """
    state, told = begin(family), []
    while not state.ended:
        piece = program[len(state.pieces)] if len(state.pieces) < len(program) else Piece("end")
        word = (piece.operation, piece.place, piece.detail)[len(state.open)]
        token = INDEX[f"{_SLOTS[len(state.open)]} {word}"]
        if token not in choices(state):
            raise ValueError(f"{'; '.join(map(str, program))!r} can't be said of the family {family}")
        told.append((token, choices(state)))
        state = advance(state, token)
    if state.pieces != program:
        raise ValueError(f"nothing can follow {'; '.join(map(str, state.pieces))!r}")
    return told
