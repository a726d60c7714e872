"""Programs: what a sentence asks for, as a short sequence that a network can spell and a person can read.

A program is steps in order (``half B; centre TL``), one goal (``goal neat in 3``), or one refusal (``no action``). Each
piece of it has an operation, a place and a detail; which of them a garment allows is a table, so nothing else can be
spelled. The codes are explained in ``experiments/language/MEANINGS.md``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

MAX_PIECES = 7

NONE = "-"
"""No place or no detail."""

EDGES = ("L", "R", "T", "B")
CORNERS = ("BL", "TL", "TR", "BR")
OPPOSITE = {"L": "R", "R": "L", "T": "B", "B": "T", "BL": "TR", "TR": "BL", "TL": "BR", "BR": "TL"}
GOALS = (
    "neat", "tiny", "three-quarters", "half", "third", "quarter", "sixth", "eighth", "sixteenth", "square", "triangle",
    "small-triangle", "strip", "letter", "gate", "envelope", "point", "sleeveless", "shorts", "one-leg",
)  # fmt: skip
REASONS = ("action", "garment", "part", "impossible", "contradiction", "nonsense", "unclear")
FRACTIONS = ("1/3", "1/4", "1/5", "1/6", "1/8", "2/3", "2/5", "3/4")
MANNERS = ("straight", "slanted", "any")
COUNTS = ("1", "2", "3", "4", "5", "6")
LENGTHS = ("#1", "#2", "#3", "#4")
"""Lengths, in the order in which a sentence names them."""

_WAYS = (*EDGES, "side", "end", "any")

OPERATIONS = ("end", "half", "mid", "strip", "centre", "across", "sleeve", "goal", "fit", "no")
PLACES = (NONE, *_WAYS, "long", "short", *CORNERS, *GOALS, *REASONS, *LENGTHS)
DETAILS = (NONE, *MANNERS, *FRACTIONS, *COUNTS, *(f"point-{side}" for side in ("T", "L", "R", "B", "any")), *LENGTHS)

_ANY_GOALS = ("neat", "tiny", "three-quarters", "half", "third", "quarter", "sixth", "eighth", "strip", "letter")
_CLOTH_GOALS = (*_ANY_GOALS, "sixteenth", "square", "triangle", "small-triangle", "gate", "envelope", "point")
_CORNERS = {"centre": (*CORNERS, "any"), "across": (*CORNERS, "any")}
_STRIPS = {"strip": (*EDGES, "any")}
_ALLOWED: dict[str, dict[str, tuple[str, ...]]] = {
    "square": {"half": _WAYS, "mid": _WAYS, **_STRIPS, **_CORNERS, "goal": _CLOTH_GOALS},
    "rectangle": {"half": (*_WAYS, "long", "short"), "mid": _WAYS, **_STRIPS, **_CORNERS, "goal": _CLOTH_GOALS},
    "tshirt": {
        "half": _WAYS, "mid": (*EDGES, "any"), **_STRIPS, "sleeve": ("L", "R", "any"),
        "goal": (*_ANY_GOALS, "sleeveless"),
    },
    "pants": {
        "half": _WAYS, "mid": (*EDGES, "any"), **_STRIPS,
        "goal": (*_ANY_GOALS, "sixteenth", "shorts", "one-leg"),
    },
    "other": {"half": _WAYS, "mid": _WAYS, **_STRIPS, "goal": _ANY_GOALS},
}  # fmt: skip


@dataclass(frozen=True)
class Piece:
    """One step, a goal, a size that a goal must fit in, or a refusal; see the module."""

    operation: str
    place: str = NONE
    detail: str = NONE

    def __str__(self) -> str:
        return " ".join(word for word in (self.operation, self.place, self.detail) if word != NONE)


Program = tuple[Piece, ...]


def operations_after(family: str, before: Program) -> tuple[str, ...]:
    """What may come after some pieces on a garment of this family."""
    steps = tuple(op for op in _ALLOWED[family] if op != "goal")
    if not before:
        return (*steps, "goal", "no")
    last = before[-1].operation
    if last == "goal":
        return ("end", "fit") if before[-1].place == "neat" else ("end",)
    if last in ("no", "fit") or len(before) >= MAX_PIECES:
        return ("end",)
    return ("end", *steps)


def places_of(family: str, operation: str) -> tuple[str, ...]:
    """Where an operation may take place on a garment of this family."""
    return {"no": REASONS, "fit": LENGTHS}.get(operation) or _ALLOWED[family].get(operation, (NONE,))


def details_of(operation: str, place: str) -> tuple[str, ...]:
    """Which details an operation has at a place."""
    if operation == "goal":
        points = tuple(detail for detail in DETAILS if detail.startswith("point"))
        return {"point": points, "neat": (NONE, *COUNTS)}.get(place, (NONE,))
    return {"strip": (*FRACTIONS, *LENGTHS), "sleeve": MANNERS, "fit": LENGTHS}.get(operation, (NONE,))


def parse_program(code: str) -> tuple[Program, tuple[float, ...]]:
    """A written code as a program and the lengths [cm] that it names, in order.

    Raises:
        ValueError: if the code is none.
    """
    lengths: list[float] = []
    pieces: list[Piece] = []
    for text in code.split("; "):
        pieces += _pieces(text, lengths)
    return tuple(pieces), tuple(lengths)


def _pieces(text: str, lengths: list[float]) -> Iterable[Piece]:
    operation, *words = text.split()
    if operation == "goal":
        yield _goal(words)
        if fits := re.search(r"fit ([\d.]+)x([\d.]+)", text):
            lengths += [float(fits[1]), float(fits[2])]
            yield Piece("fit", f"#{len(lengths) - 1}", f"#{len(lengths)}")
        return
    if words and (length := re.fullmatch(r"([\d.]+)cm", words[-1])):
        lengths.append(float(length[1]))
        words[-1] = f"#{len(lengths)}"
    piece = Piece(operation, *words)
    known = piece.operation in OPERATIONS and piece.place in PLACES and piece.detail in DETAILS
    if not known or piece.detail not in details_of(piece.operation, piece.place):
        raise ValueError(f"{text!r} is no step, goal or refusal")
    yield piece


def _goal(words: list[str]) -> Piece:
    name = words[0] if words else ""
    if name not in GOALS:
        raise ValueError(f"{name!r} is no goal")
    if name == "point":
        return Piece("goal", name, f"point-{words[1]}")
    return Piece("goal", name, words[words.index("in") + 1] if "in" in words else NONE)
