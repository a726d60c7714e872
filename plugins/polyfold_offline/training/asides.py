"""What people add to a wish without asking for more: what comes of it, what stays, how many folds it is, talk."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

from polyfold_offline.meaning.program import CORNERS, EDGES, Piece, Program
from polyfold_offline.training.corpus import Example

OPPOSITE = {"L": "R", "R": "L", "T": "B", "B": "T", "BL": "TR", "TR": "BL", "TL": "BR", "BR": "TL"}


@cache
def _phrases(name: str) -> Mapping[str, Any]:
    return tomllib.loads(Path(__file__).with_name(name).read_text(encoding="utf-8"))


def with_aside(example: Example, random: Random) -> Example:
    """The wish with something added that changes nothing, or that says there is to be one fold where it takes more."""
    if example.program[0].operation == "no":
        return example
    if example.program[0].operation == "goal":
        return _talked(example, random)
    return random.choice(_WAYS)(example, random)


def _with(example: Example, text: str, program: Program | None = None) -> Example:
    return Example(example.family, text, program or example.program, example.register)


def _bare(text: str) -> str:
    return text.rstrip(" .!")


def _begun(text: str, random: Random) -> str:
    return text[0].upper() + text[1:] if random.random() < _CAPITAL else text


_CAPITAL = 0.6


# What comes of it -----------------------------------------------------------------------------------------------------


def _comes_of(example: Example, random: Random) -> Example:
    said = [
        phrase for key in _keys(example.program, example.family) for phrase in _phrases("asides.toml")["comes_of"][key]
    ]
    if not said:
        return example
    return _with(example, f"{_bare(example.text)}{random.choice((', ', ', ', '. ', ' - ', ' '))}{random.choice(said)}.")


def _keys(program: Program, family: str) -> list[str]:
    """The lists of phrases that tell what comes of a program."""
    operations = [piece.operation for piece in program]
    if operations == ["half", "half"]:
        return ["quarter"]
    if len(program) > 1 or operations[0] not in _phrases("asides.toml")["comes_of"]:
        return []
    way = {"L": "side", "R": "side", "T": "end", "B": "end"}.get(program[0].place, "")
    if operations[0] != "half" or not way:
        return operations
    return ["half", f"pants-{way}" if family == "pants" else way]


# What stays -----------------------------------------------------------------------------------------------------------


def _leaves(example: Example, random: Random) -> Example:
    stays = _untouched(example.program)
    if not stays:
        return example
    parts = _phrases("phrases.toml")["parts"]
    names = {**parts["plain"], **parts.get(example.family, {})}
    if any(piece.operation == "sleeve" for piece in example.program):
        names = _phrases("phrases.toml")["sleeves"]
    told = " and the ".join(random.choice(names[place]) for place in stays)
    if len(stays) > 1 and random.random() < _REST:
        told = f"other {('two', 'three')[len(stays) - 2]}"
    ways = _phrases("asides.toml")["leaves"]
    if random.random() < _BEFORE and not told.startswith("other"):
        return _with(example, _begun(random.choice(ways["before"]).format(q=told), random) + example.text)
    return _with(example, f"{_bare(example.text)}{random.choice(ways['after']).format(q=told)}.")


_REST, _BEFORE = 0.4, 0.55


def _untouched(program: Program) -> list[str]:
    """Named parts that a program leaves where they are."""
    places = [piece.place for piece in program]
    operations = {piece.operation for piece in program}
    if "sleeve" in operations:
        sides = {piece.place for piece in program if piece.operation == "sleeve"}
        return [OPPOSITE[side] for side in sides] if len(sides) == 1 and sides <= {"L", "R"} else []
    if operations == {"centre"} and set(places) <= set(CORNERS):
        return [corner for corner in CORNERS if corner not in places]
    if len(program) == 1 and operations <= {"half", "mid", "strip", "across"} and places[0] in (*EDGES, *CORNERS):
        return [OPPOSITE[places[0]]]
    return []


# How many -------------------------------------------------------------------------------------------------------------


def _counted(example: Example, random: Random) -> Example:
    counts, many = _phrases("asides.toml")["counts"], len(example.program)
    if many > len(_NUMBERS) or ("fold" in example.text and any(f"{n} " in example.text.lower() for n in _NUMBERS)):
        return example
    number = random.choice(counts[_NUMBERS[many - 1]])
    if random.random() < 0.5:
        return _with(example, _begun(random.choice(counts["before"]).format(n=number), random) + example.text)
    return _with(example, f"{_bare(example.text)}{random.choice(counts['after']).format(n=number)}.")


_NUMBERS = ("one", "two", "three", "four")


def _too_many(example: Example, random: Random) -> Example:
    """The wish for several folds, and for one fold only."""
    if len(example.program) != 2 or "half any" in map(str, example.program):
        return _ended(example, random)
    counts, never = _phrases("asides.toml")["counts"], (Piece("no", "contradiction"),)
    if random.random() < 0.5:
        return _with(example, _begun(random.choice(counts["against"]), random) + example.text, never)
    return _with(example, f"{_bare(example.text)}{random.choice(counts['against-after'])}.", never)


def _ended(example: Example, random: Random) -> Example:
    return _with(example, f"{_bare(example.text)}{random.choice(_phrases('asides.toml')['ends']['said'])}.")


# Talk -----------------------------------------------------------------------------------------------------------------


def _talked(example: Example, random: Random) -> Example:
    """The wish within a stream of talk."""
    talk = _phrases("asides.toml")["talk"]

    def some(most: int) -> list[str]:
        return random.sample(talk["said"], random.randrange(most + 1))

    before, after = some(2), some(3)
    if random.random() < _STREAM:
        told, joins = example.text.rstrip(" .!"), talk["joins"]
        text = "".join(part + random.choice(joins) for part in before) + told[0].lower() + told[1:]
        return _with(example, text + "".join(random.choice(joins) + part for part in after))
    sentences = [*(_begun(part, random) for part in before), example.text.rstrip(), *(_begun(p, random) for p in after)]
    return _with(example, ". ".join(part.rstrip(".") for part in sentences) + ".")


_STREAM = 0.7

_WAYS: Sequence[Callable[[Example, Random], Example]] = (
    _comes_of, _comes_of, _comes_of, _leaves, _leaves, _leaves, _counted, _too_many, _ended, _ended, _talked, _talked,
)  # fmt: skip
