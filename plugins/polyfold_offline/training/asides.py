"""What people add to a wish without asking for more: what comes of it, what stays, how many folds it is, talk."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from random import Random

from polyfold_offline.meaning.program import CORNERS, EDGES, OPPOSITE, Piece, Program
from polyfold_offline.training.corpus import Example
from polyfold_offline.training.phrases import phrases


def with_aside(example: Example, random: Random) -> Example:
    """The wish with something added that changes nothing, or that says there is to be one fold where it takes more."""
    if example.program[0].operation == "no":
        return example
    if example.program[0].operation == "goal":
        return _talked(example, random)
    return random.choice(_WAYS)(example, random)


def _with(example: Example, text: str, program: Program | None = None) -> Example:
    return Example(example.family, text, program or example.program, example.register)


def _beside(
    example: Example, ways: Mapping[str, Sequence[str]], random: Random, program: Program | None = None, **words: str
) -> Example:
    """The example with a phrase before or after it, whichever ``ways`` has."""
    place = random.choice([name for name in ("before", "after") if name in ways])
    said = random.choice(ways[place]).format(**words)
    if place == "before":
        return _with(example, _begun(said, random) + example.text, program)
    return _with(example, f"{_bare(example.text)}{said}.", program)


def _bare(text: str) -> str:
    return text.rstrip(" .!")


def _begun(text: str, random: Random) -> str:
    return text[0].upper() + text[1:] if random.random() < _CAPITAL else text


_CAPITAL = 0.6


# What comes of it -----------------------------------------------------------------------------------------------------


def _comes_of(example: Example, random: Random) -> Example:
    lists = [phrases("asides")["comes_of"][key] for key in _keys(example.program, example.family)]
    said = [random.choice((", ", ", ", ". ", " - ", " ")) + phrase for phrase in chain(*lists)]
    return _beside(example, {"after": said}, random) if said else example


def _keys(program: Program, family: str) -> list[str]:
    """The lists of phrases that tell what comes of a program."""
    first, operations = program[0], [piece.operation for piece in program]
    if operations == ["half", "half"]:
        return ["quarter"]
    if len(operations) > 1 or operations[0] not in phrases("asides")["comes_of"]:
        return []
    way = {"L": "side", "R": "side", "T": "end", "B": "end"}.get(first.place, "")
    if operations[0] != "half" or not way:
        return operations
    return ["half", f"pants-{way}" if family == "pants" else way]


# What stays -----------------------------------------------------------------------------------------------------------


def _leaves(example: Example, random: Random) -> Example:
    stays, ways = _untouched(example.program), phrases("asides")["leaves"]
    if not stays:
        return example
    if len(stays) > 1 and random.random() < _REST:
        return _beside(example, {"after": ways["after"]}, random, q=f"other {('two', 'three')[len(stays) - 2]}")
    said = phrases("plain")
    names = {**said["parts"]["plain"], **said["parts"].get(example.family, {})}
    if any(piece.operation == "sleeve" for piece in example.program):
        names = said["sleeves"]
    return _beside(example, ways, random, q=" and the ".join(random.choice(names[place]) for place in stays))


_REST = 0.4
"""Share of several parts that are called the others."""


def _untouched(program: Program) -> list[str]:
    """Named parts that a program leaves where they are."""
    places = [piece.place for piece in program]
    operations = {piece.operation for piece in program}
    if "sleeve" in operations:
        # The other sleeve lies still as long as nothing goes sideways besides.
        sides = {place for place in places if place not in ("T", "B")}
        return [OPPOSITE[side] for side in sides] if len(sides) == 1 and sides <= {"L", "R"} else []
    if operations == {"centre"} and set(places) <= set(CORNERS):
        return [corner for corner in CORNERS if corner not in places]
    if len(program) == 1 and operations <= {"half", "mid", "strip", "across"} and places[0] in (*EDGES, *CORNERS):
        return [OPPOSITE[places[0]]]
    return []


# How many -------------------------------------------------------------------------------------------------------------


def _counted(example: Example, random: Random) -> Example:
    counts, many = phrases("asides")["counts"], len(example.program)
    if many > len(_NUMBERS):
        return example
    return _beside(example, counts, random, n=random.choice(counts[_NUMBERS[many - 1]]))


_NUMBERS = ("one", "two", "three", "four")


def _too_many(example: Example, random: Random) -> Example:
    """The wish for two folds, and for one fold only; of any other wish, that this is all."""
    if len(example.program) != 2 or Piece("half", "any") in example.program:
        return _ended(example, random)
    return _beside(example, phrases("asides")["against"], random, (Piece("no", "contradiction"),))


def _ended(example: Example, random: Random) -> Example:
    return _beside(example, phrases("asides")["ends"], random)


# Talk -----------------------------------------------------------------------------------------------------------------


def _talked(example: Example, random: Random) -> Example:
    """The wish within a stream of talk."""
    talk = phrases("asides")["talk"]

    def some(most: int) -> list[str]:
        return random.sample(talk["said"], random.randrange(most + 1))

    before, after = some(2), some(3)
    if random.random() < _STREAM:
        told, joins = _bare(example.text), talk["joins"]
        text = "".join(part + random.choice(joins) for part in before) + told[0].lower() + told[1:]
        return _with(example, text + "".join(random.choice(joins) + part for part in after))
    sentences = [*(_begun(part, random) for part in before), example.text.rstrip(), *(_begun(p, random) for p in after)]
    return _with(example, ". ".join(part.rstrip(".") for part in sentences) + ".")


_STREAM = 0.7

_WAYS: Sequence[Callable[[Example, Random], Example]] = (
    _comes_of, _comes_of, _comes_of, _leaves, _leaves, _leaves, _counted, _too_many, _ended, _ended, _talked, _talked,
)  # fmt: skip
