"""Goals: choosing, among the ends of known fold sequences, one that a goal is content with and that takes few folds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import log

from polyfold_offline.cloth.folds import Fold
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.outcomes import Outcome, outcomes
from polyfold_offline.meaning.program import NONE, Piece

Test = Callable[[Outcome], bool]

SMALL = {"tshirt": 0.54, "pants": 0.25}
"""A pile for a drawer covers at most this share of the flat garment; the sleeves of t-shirts are thin."""

PLAIN_SMALL = 0.42
"""... of a plain cloth this share,"""

FEW_SMALL = 0.6
"""... or this, if few folds are asked for."""

MISSED = 3.0
"""A size missed by a factor e is as bad as this many more folds."""

_RAGGED = 2.0
"""Among ends of a wished size, one that fills less than 4/5 of its rectangle is as bad as this many more folds."""

_SLIM = 0.2
"""Among ends of as many folds the more compact is meant: a quarter is rather half as wide and tall than a strip."""

_WIDE = 1.5
"""A strip that is more than a third as wide as long is as bad as this many more folds."""

_SHARES = {
    "three-quarters": 3 / 4, "half": 1 / 2, "third": 1 / 3, "quarter": 1 / 4, "sixth": 1 / 6, "eighth": 1 / 8,
    "sixteenth": 1 / 16,
}  # fmt: skip
_COMPACT = ("neat", *_SHARES)
_NEARLY = 1.5
"""What is at most so many times as large as the smallest end counts as small as it gets."""

_SIDES = {"T": "top", "B": "bottom", "L": "left", "R": "right"}


def folds_for_goal(goal: Piece, size_cm: tuple[float, float] | None, garment: Garment) -> list[Fold]:
    """The folds whose end is what a goal asks for.

    Args:
        goal: the goal.
        size_cm: width and height that the end must fit in, either way round [cm].
        garment: what lies on the table.

    Raises:
        NotUnderstoodError: if no known sequence ends so; the message names the first thing that can't be had.
    """
    found = list(outcomes(garment.family))
    for words, content in demands(goal, size_cm, garment):
        remaining = [outcome for outcome in found if content(outcome)]
        if not remaining:
            raise NotUnderstoodError(f"I know no way to fold a {garment.spoken} so that it is {words}")
        found = remaining
    return list(min(found, key=lambda outcome: _cost(outcome, goal)).folds)


def _cost(outcome: Outcome, goal: Piece) -> float:
    if goal.place == "neat" and goal.detail != NONE:
        return outcome.area  # so many folds were asked for, all ends have as many
    cost = len(outcome.folds) + (_SLIM * (1.0 - outcome.slim) if goal.place in _COMPACT else 0.0)
    if goal.place == "strip":
        return cost + _WIDE * (outcome.slim > 0.34)
    if (share := _SHARES.get(goal.place)) is None:
        return cost
    return cost + MISSED * abs(log(outcome.area / share)) + _RAGGED * (outcome.rectangular < 0.8)


def demands(goal: Piece, size_cm: tuple[float, float] | None, garment: Garment) -> Iterator[tuple[str, Test]]:
    """What an end must be, in words and as a test; arguments as for :func:`folds_for_goal`."""
    count = int(goal.detail) if goal.place == "neat" and goal.detail != NONE else None
    if goal.place == "point":
        side = _SIDES.get(goal.detail.removeprefix("point-"), "")
        yield f"pointed at the {side or 'end'}", lambda outcome: _pointed(outcome, side)
    elif goal.place == "neat" and (size_cm or count):
        yield "a block", lambda outcome: outcome.rectangular > 0.7 and outcome.area <= FEW_SMALL
    elif goal.place == "neat":
        small = SMALL.get(garment.family, PLAIN_SMALL)
        yield "a small block", lambda o: o.rectangular > 0.85 and o.area <= small and o.slim > 0.3
    elif goal.place == "tiny":
        smallest = min(outcome.area for outcome in outcomes(garment.family))
        yield "as small as it gets", lambda outcome: outcome.area < _NEARLY * smallest
    else:
        yield _WORDS[goal.place], _TESTS[goal.place]
    if count is not None:
        yield f"done in {count} fold{'s' * (count > 1)}", lambda outcome: len(outcome.folds) == count
    if size_cm is not None:
        yield f"at most {size_cm[0]:g} x {size_cm[1]:g} cm", lambda outcome: _fits(outcome, size_cm, garment)


def _fits(outcome: Outcome, size_cm: tuple[float, float], garment: Garment) -> bool:
    if garment.size_cm is None:
        raise NotUnderstoodError("nothing says how large the garment is, so I can't tell what fits")
    extent = sorted((outcome.width * garment.size_cm[0], outcome.height * garment.size_cm[1]))
    return all(have <= limit for have, limit in zip(extent, sorted(size_cm), strict=True))


def _actions(outcome: Outcome) -> list[str]:
    return [fold.action for fold in outcome.folds]


def _ears(outcome: Outcome) -> list[str]:
    return [fold.part for fold in outcome.folds if fold.target == "centre"]


def _pointed(outcome: Outcome, side: str) -> bool:
    """Whether both corners of an edge are folded in; of any edge, if none is named."""
    ears = [set(ear.split("_")) for ear in _ears(outcome)]
    return len(ears) == len(outcome.folds) == 2 and bool(ears[0] & ears[1]) and side in {"", *(ears[0] & ears[1])}


def _halves(outcome: Outcome, *edges: str) -> bool:
    return len(outcome.folds) == 1 and outcome.folds[0].action == "half" and outcome.folds[0].part in edges


def _sized(share: float) -> Test:
    return lambda outcome: abs(log(outcome.area / share)) < 0.23


def _triangle(outcome: Outcome) -> bool:
    return outcome.triangular > 0.85 and outcome.rectangular < 0.85


_TESTS: dict[str, Test] = {
    **{name: _sized(share) for name, share in _SHARES.items()},
    "square": lambda outcome: outcome.rectangular > 0.85 and outcome.slim > 0.65 and outcome.area < 0.6,
    "triangle": _triangle,
    "small-triangle": lambda outcome: _triangle(outcome) and outcome.area < 0.3,
    "strip": lambda outcome: outcome.rectangular > 0.7 and outcome.slim < 0.55 and outcome.width < 0.6,
    "letter": lambda outcome: _actions(outcome)[-2:] == ["band", "band"],
    "gate": lambda outcome: _actions(outcome) == ["middle", "middle"],
    "envelope": lambda outcome: len(_ears(outcome)) == len(outcome.folds) == 4,
    "sleeveless": lambda outcome: _actions(outcome) == ["sleeve", "sleeve"],
    "shorts": lambda outcome: _halves(outcome, "top", "bottom"),
    "one-leg": lambda outcome: _halves(outcome, "left", "right"),
}
_WORDS = {
    "three-quarters": "three quarters as large", "half": "half as large",
    "third": "a third as large", "quarter": "a quarter as large",
    "sixth": "a sixth as large", "eighth": "an eighth as large", "sixteenth": "a sixteenth as large",
    "square": "a smaller square", "triangle": "a triangle", "small-triangle": "a halved triangle",
    "strip": "a narrow band", "letter": "folded like a letter", "gate": "folded like cupboard doors",
    "envelope": "folded like an envelope", "sleeveless": "without sleeves", "shorts": "as short as shorts",
    "one-leg": "one leg on the other",
}  # fmt: skip
