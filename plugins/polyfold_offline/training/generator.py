"""Plain sentences for meanings drawn at random: what written ones name too seldom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.folding import folds_of
from polyfold_offline.meaning.program import (
    CORNERS,
    EDGES,
    LENGTHS,
    MANNERS,
    OPPOSITE,
    Piece,
    Program,
    details_of,
    places_of,
)
from polyfold_offline.reading.tokens import TOKENS, advance, begin, choices
from polyfold_offline.training.corpus import Example
from polyfold_offline.training.phrases import phrases

_FAMILIES = ("square", "rectangle", "tshirt", "pants", "other")


def generate(count: int, seed: int) -> list[Example]:
    """So many sentences, the same for a seed."""
    random = Random(seed)
    found: list[Example] = []
    while len(found) < count:
        family = random.choice(_FAMILIES)
        program = _program(family, random)
        if program is not None:
            text = _Speaker(family, phrases("plain"), random).say(program)
            found.append(Example(family, text, program, "generated"))
    return found


def _program(family: str, random: Random) -> Program | None:
    """A program that makes sense, with at most three steps."""
    if family in ("square", "rectangle") and random.random() < _THREE_CORNERS:
        left_out = random.choice(_CLOCKWISE)
        return tuple(Piece("centre", place) for place in _CLOCKWISE if place != left_out)
    if family in _LISTS and random.random() < _LISTED:
        operation, places, detail = random.choice(_LISTS[family])
        return tuple(Piece(operation, place, detail) for place in _some_of(places, random))
    if random.random() < _EVERYDAY:
        operation, places, details = random.choice([step for step in _STEPS if _allows(family, *step)])
        return (Piece(operation, random.choice(places), random.choice(details)),)
    state = begin(family)
    while not state.ended:
        token = random.choice([t for t in choices(state) if TOKENS[t] != "operation no"])
        if not state.open and len(state.pieces) >= random.choice((1, 1, 2, 2, 3)):
            ends = [t for t in choices(state) if TOKENS[t] == "operation end"]
            token = (ends or [token])[0]
        state = advance(state, token)
    if _lengths(state.pieces) != list(LENGTHS[: len(_lengths(state.pieces))]):
        return None
    if any(p.operation in ("strip", "mid") and p.place == "any" for p in state.pieces):
        return None
    try:
        folds_of(state.pieces, (20.0, 30.0, 10.0, 10.0), Garment(family, family, {}, (60.0, 60.0)))
    except NotUnderstoodError:
        return None if state.pieces[0].operation != "goal" else state.pieces
    return state.pieces


def _allows(family: str, operation: str, places: Sequence[str], details: Sequence[str]) -> bool:
    return set(places) <= set(places_of(family, operation)) and set(details) <= set(details_of(operation, places[0]))


def _lengths(program: Program) -> list[str]:
    return [word for piece in program for word in (piece.place, piece.detail) if word in LENGTHS]


class _Speaker:
    """Says programs in one way of naming sides."""

    def __init__(self, family: str, said: Mapping[str, Any], random: Random) -> None:
        self._phrases, self._random = said, random
        system = random.choice(_SYSTEMS)
        self._parts = dict(said["parts"].get(family, said["parts"]["plain"]))
        self._sleeves = dict(said["sleeves"])
        if system != "plain":
            self._rename(family, system)

    def _rename(self, family: str, system: str) -> None:
        """Name sides by compass, clock or from where the speaker stands."""
        named, sides = self._phrases[system], self._phrases["sides"][system]
        if family in ("square", "rectangle", "other"):
            self._parts |= named
        for side, word in sides.items():
            self._sleeves[side] = [f"{word} sleeve", f"sleeve at {word}", f"sleeve on the {word} side"]
            if family == "pants":
                self._parts[side] = [f"{word} leg", f"leg at {word}", f"leg on the {word} side"]
            if family == "tshirt":
                self._parts[side] = [f"{word} half", f"half at {word}", f"side at {word}"]

    def say(self, program: Program) -> str:
        """A sentence that asks for a program."""
        random = self._random
        if program[0].operation == "goal":
            told = self._goal(program)
        elif len(program) == 1 and random.random() < _TURNED:
            told = self._turned(program[0])
        elif len(program) == 2 and random.random() < _TURNED:
            told = random.choice(self._phrases["turns"]["before"]).format(
                a=self._step(program[0]), b=self._step(program[1], 1)
            )
        elif _three_corners(program):
            left_out = next(place for place in _CLOCKWISE if place not in {p.place for p in program})
            told = random.choice(self._phrases["turns"]["except"]).format(q=self._name(program[0], left_out))
        elif _is_list(program) and random.random() < _TOLD_AS_LIST:
            told = self._list(program)
        else:
            told = "".join(
                (random.choice(self._phrases["joints"][:-1]) if number else "")
                + (self._turned(piece) if self._may_turn(piece, program) else self._step(piece, number))
                for number, piece in enumerate(program)
            )
        text = random.choice(self._phrases["openings"]) + told + random.choice(self._phrases["closings"])
        return text[0].upper() + text[1:] if random.random() < 0.5 else text

    def _may_turn(self, piece: Piece, program: Program) -> bool:
        """Whether to correct or deny something in this step: only of a part that no other step moves."""
        other = _MIRRORED.get(piece.place)
        return self._random.random() < _CORRECTED and other not in {step.place for step in program}

    def _list(self, program: Program) -> str:
        """Several parts with one movement, in the order in which they are named, or numbered."""
        lists, random = self._phrases["lists"], self._random
        named = [f"the {self._name(piece, piece.place)}" for piece in program]
        kind = program[0].operation
        move = random.choice(lists["moves"].get(kind) or self._phrases["manners"][program[0].detail])
        if random.random() < _NUMBERED:
            numbers = [*lists["numbers"][: len(named) - 1], random.choice(("last", lists["numbers"][len(named) - 1]))]
            pairs = [
                random.choice((f"{number} {name}", f"{name} {number}"))
                for number, name in zip(numbers, named, strict=True)
            ]
            if random.random() < _SHUFFLED:
                random.shuffle(pairs)
            told = ", ".join(pairs)
        else:
            joint = random.choice(lists["joints"])
            told = joint.join(named[:-1]) + random.choice((joint, *lists["last"])) + named[-1]
        return random.choice(lists["said"]).format(list=told, move=move)

    def _turned(self, piece: Piece) -> str:
        """One step, said with a correction, a negation or an exception."""
        turns, other, random = self._phrases["turns"], _MIRRORED.get(piece.place), self._random
        if other is None:
            return self._step(piece)
        wrong = Piece(piece.operation, other, piece.detail)
        names = {
            "p": self._name(piece, piece.place),
            "r": self._name(piece, piece.place),
            "q": self._name(piece, other),
        }
        ways = [*turns["wrong"], *turns["restart"]]
        if piece.operation == "centre":
            ways += turns["only"] * 3
        if piece.operation == "sleeve" and piece.detail == "any":
            ways += turns["others"] * 3
        return random.choice(ways).format(a=self._step(piece), x=self._step(wrong), **names)

    def _name(self, piece: Piece, place: str) -> str:
        names = self._sleeves if piece.operation == "sleeve" else self._parts
        return self._random.choice(names.get(place, ["part"]))

    def _goal(self, program: Program) -> str:
        goal, said = program[0], self._phrases["goal"]
        told = self._random.choice(said[goal.detail if goal.place == "point" else goal.place])
        if goal.place == "neat" and goal.detail != "-":
            told += self._random.choice(said["in"]).format(n=goal.detail)
        if len(program) > 1:
            told += self._random.choice(said["fit"]).format(a=program[1].place, b=program[1].detail)
        return told

    def _step(self, piece: Piece, number: int = 0) -> str:
        key = piece.operation
        if piece.place not in (*EDGES, *CORNERS):
            key += "-again" if key == "half" and piece.place == "any" and number else f"-{piece.place}"
        said = self._random.choice(self._phrases["say"].get(key) or self._phrases["say"][piece.operation])
        a, b = self._diagonal(piece)
        return said.format(
            p=self._name(piece, piece.place),
            o=self._random.choice(self._parts.get(OPPOSITE.get(piece.place, ""), ["other side"])),
            w=self._random.choice(self._phrases["widths"].get(piece.detail, [f"{piece.detail} cm"])),
            m=self._random.choice(self._phrases["manners"].get(piece.detail, [""])),
            a=a,
            b=b,
        )

    def _diagonal(self, piece: Piece) -> list[str]:
        """The corners between which the crease runs when a corner goes onto the opposite one."""
        ends = [c for c in CORNERS if c not in (piece.place, OPPOSITE.get(piece.place))]
        self._random.shuffle(ends)
        return [self._name(piece, end) for end in ends[:2]]


_THREE_CORNERS, _LISTED = 0.04, 0.13
"""Shares of programs that fold in all corners but one, and that move several parts alike."""

_EVERYDAY = 0.35
"""Share of programs that are one step between parts that have names, said in few words: what people type first."""

_STEPS: Sequence[tuple[str, Sequence[str], Sequence[str]]] = (
    *[("half", EDGES, ("-",))] * 4,
    ("half", ("any",), ("-",)),
    ("mid", ("L", "R"), ("-",)),
    ("mid", EDGES, ("-",)),
    *[("centre", CORNERS, ("-",))] * 2,
    *[("across", CORNERS, ("-",))] * 2,
    *[("sleeve", ("L", "R"), MANNERS)] * 2,
)
"""Everyday steps: operation, places and details; the more usual ones stand more often."""

_CORRECTED = 0.12
"""Share of the steps of longer sentences that correct or deny something."""

_TOLD_AS_LIST, _NUMBERED, _SHUFFLED = 0.75, 0.35, 0.3
"""Shares of the latter that are told as a list, of lists that are numbered, and of these that are told out of order."""

_SYSTEMS = ("plain", "plain", "plain", "compass", "clock", "facing")
_TURNED = 0.3
"""Share of sentences that correct, deny or tell in another order."""

_MIRRORED = {"L": "R", "R": "L", "T": "B", "B": "T", "BL": "BR", "BR": "TR", "TR": "TL", "TL": "BL"}


_CLOCKWISE = ("BL", "TL", "TR", "BR")
_CORNER_LISTS = [
    ("centre", _CLOCKWISE, "-"),
    ("centre", _CLOCKWISE, "-"),
    ("mid", ("L", "R"), "-"),
    ("mid", ("T", "B"), "-"),
]
_SLEEVES = [("sleeve", ("L", "R"), manner) for manner in ("straight", "slanted", "any")]
_LISTS = {"square": _CORNER_LISTS, "rectangle": _CORNER_LISTS, "tshirt": [*_SLEEVES, ("mid", ("L", "R"), "-")]}


def _some_of(places: Sequence[str], random: Random) -> list[str]:
    return random.sample(places, random.randint(2, len(places)))


def _is_list(program: Program) -> bool:
    same = {(piece.operation, piece.detail) for piece in program}
    return len(program) > 1 and len(same) == 1 and program[0].operation in ("centre", "mid", "sleeve")


def _three_corners(program: Program) -> bool:
    """Whether three corners go to the centre, in the order in which they are taken when none is said."""
    places = [piece.place for piece in program if piece.operation == "centre"]
    return len(program) == len(places) == 3 and places == [place for place in _CLOCKWISE if place in places]
