"""Choosing, among the ends of known fold sequences, the one that a wish is content with and that takes fewest folds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import log

from polyfold_rules.shapes.folds import OPPOSITE_CORNER, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.wishes.outcomes import Outcome, outcomes
from polyfold_rules.wishes.wish import Bound, Wish

Demand = tuple[str, Callable[[Outcome], bool]]
"""What an end must be, in words and as a test."""

SMALL = {"quad": 0.42, "tshirt": 0.54, "pants": 0.25}
"""A pile for a drawer covers at most this share of the flat garment; the sleeves of t-shirts are thin."""
SMALL_ENOUGH = 0.42
"""... or this, if few folds are allowed."""

MISSED = 3.0
"""A size missed by a factor e is as bad as this many more folds."""


def folds_for_wish(wish: Wish, garment: Garment) -> list[Fold]:
    """The folds whose end is what the wish asks for.

    Raises:
        NotUnderstoodError: if no known sequence ends so; the message names the first thing that can't be had.
    """
    found = list(outcomes(garment.kind, garment.family))
    for words, content in _demands(wish, garment):
        remaining = [outcome for outcome in found if content(outcome)]
        if not remaining:
            raise NotUnderstoodError(f"I know no way to fold a {garment.spoken} so that it is {words}")
        found = remaining
    best = min(found, key=lambda outcome: _cost(outcome, wish))
    for word in wish.passed:
        garment.note(f"I pass over the word “{word}”, which I do not know.")
    garment.note(
        f"Nothing is said about the folds. Of the ways that I know, {len(best.folds)} "
        f"fold{'s' * (len(best.folds) > 1)} to {best.area:.2f} of the area, {best.width:.2f} of the width and "
        f"{best.height:.2f} of the height come nearest."
    )
    return list(best.folds)


def _cost(outcome: Outcome, wish: Wish) -> float:
    if wish.least:
        return outcome.area + 0.001 * len(outcome.folds)
    missed = sum(abs(log(_value(outcome, bound) / bound.aim)) for bound in wish.bounds if bound.aim)
    return len(outcome.folds) + MISSED * missed


def _demands(wish: Wish, garment: Garment) -> Iterator[Demand]:
    for bound in wish.bounds:
        yield _say_bound(bound), lambda outcome, bound=bound: _keeps(outcome, bound)
    for shape in dict.fromkeys(wish.shapes):
        yield f"a {shape}", lambda outcome, shape=shape: _is_shape(outcome, shape, wish)
    for look in dict.fromkeys(wish.looks):
        yield f"like a {look}", lambda outcome, look=look: _LOOKS[look](outcome)
    if wish.hidden:
        yield "without the parts that should be gone", lambda outcome: wish.hidden == _gone(outcome)
    for side in sorted(wish.kept):
        yield f"left at the {side}", lambda outcome, side=side: not any(side in _moved(fold) for fold in outcome.folds)
    for side in sorted(wish.lies):
        yield f"at the {side}", lambda outcome, side=side: _lies(outcome, side)
    if wish.points:
        yield f"pointing to the {wish.points}", lambda outcome: outcome.points == {wish.points}
    for purpose in dict.fromkeys(wish.purposes):
        yield f"fit for a {purpose}", lambda outcome, purpose=purpose: _suits(outcome, purpose, wish, garment)
    if (wish.small or wish.least or wish.merely_tidy) and not (wish.sized or wish.looks):
        yield "small", lambda outcome: outcome.area <= _small(wish, garment)
    if wish.steps is not None:
        least, most = wish.steps
        count = f"{least}" if least == most else f"at most {most}"
        yield f"done in {count} fold{'s' * (most > 1)}", lambda outcome: least <= len(outcome.folds) <= most


def _say_bound(bound: Bound) -> str:
    if bound.aim:
        return f"{bound.aim:.2f} of its {bound.quantity}"
    if bound.low:
        return f"as large in {bound.quantity} as now"
    return f"no more than {bound.high:.2f} of its {bound.quantity}"


def _small(wish: Wish, garment: Garment) -> float:
    share = SMALL.get(garment.family, SMALL_ENOUGH)
    return max(share, SMALL_ENOUGH) if wish.steps is not None and wish.steps[1] < 3 else share


# Sizes and shapes ----------------------------------------------------------------------------------------------------


def _value(outcome: Outcome, bound: Bound) -> float:
    if bound.quantity != "length":
        return getattr(outcome, bound.quantity)
    if outcome.worn:
        return outcome.height
    sides = (outcome.width, outcome.height)
    return min(sides, key=lambda side: abs(log(side / (bound.aim or bound.high))))


def _keeps(outcome: Outcome, bound: Bound) -> bool:
    return bound.low <= _value(outcome, bound) <= bound.high


def _is_shape(outcome: Outcome, shape: str, wish: Wish) -> bool:
    if shape == "triangle":
        return outcome.triangular > 0.85 and outcome.rectangular < 0.85
    if shape == "square":
        return outcome.rectangular > 0.85 and outcome.slim > 0.65 and outcome.area < 0.7
    if shape == "strip":
        narrow = any(bound.quantity in ("width", "height", "area") for bound in wish.bounds)
        return outcome.rectangular > 0.85 and (outcome.slim < 0.55 or narrow)
    return outcome.rectangular > 0.88


def _actions(outcome: Outcome) -> list[str]:
    return [fold.action for fold in outcome.folds]


def _ears(outcome: Outcome) -> list[str]:
    return [fold.part for fold in outcome.folds if fold.target == "centre"]


_LOOKS: dict[str, Callable[[Outcome], bool]] = {
    "book": lambda outcome: _actions(outcome) == ["half"],
    "gate": lambda outcome: _actions(outcome) == ["middle", "middle"],
    "letter": lambda outcome: _actions(outcome) == ["band", "band"],
    "envelope": lambda outcome: len(_ears(outcome)) == 4,
    "house": lambda outcome: _pointed(outcome) and outcome.points == {"top"},
    "boat": lambda outcome: _pointed(outcome) and outcome.points == {"bottom"},
    "arrow": lambda outcome: _pointed(outcome),
    "pentagon": lambda outcome: _pointed(outcome) or len(_ears(outcome)) == len(outcome.folds) == 1,
    "shorts": lambda outcome: outcome.worn and _moved_edges(outcome) == ["bottom"],
    "sleeveless": lambda outcome: _actions(outcome) == ["sleeve", "sleeve"],
    "oneleg": lambda outcome: outcome.worn and _moved_edges(outcome) in (["left"], ["right"]),
    "onesleeve": lambda outcome: _actions(outcome) == ["sleeve"],
    "dogear": lambda outcome: len(_ears(outcome)) == len(outcome.folds) == 1,
    "mirrored": lambda outcome: _moved_edges(outcome) in (["left"], ["right"]),
    "hexagon": lambda outcome: len(outcome.folds) == 2 and _opposite_ears(outcome),
    "threequarter": lambda outcome: _actions(outcome) == ["band"],
}
"""What things look like, told by the folds that make them."""


def _pointed(outcome: Outcome) -> bool:
    """Whether both corners of one edge are folded in."""
    return len(_ears(outcome)) == len(outcome.folds) == 2 and len(outcome.points) == 1


def _opposite_ears(outcome: Outcome) -> bool:
    ears = _ears(outcome)
    return len(ears) == 2 and OPPOSITE_CORNER[ears[0]] == ears[1]


def _moved_edges(outcome: Outcome) -> list[str]:
    return [fold.part for fold in outcome.folds if fold.action == "half"] if {*_actions(outcome)} == {"half"} else []


def _moved(fold: Fold) -> list[str]:
    return fold.part.split("_") if fold.action == "corner" else [fold.part]


def _gone(outcome: Outcome) -> set[str]:
    return {fold.part for fold in outcome.folds if fold.action == "sleeve" or fold.target == "centre"}


def _lies(outcome: Outcome, side: str) -> bool:
    x, y = outcome.shift
    return {"left": x < -0.1, "right": x > 0.1, "top": y < -0.1, "bottom": y > 0.1}[side]


# Purposes ------------------------------------------------------------------------------------------------------------


def _suits(outcome: Outcome, purpose: str, wish: Wish, garment: Garment) -> bool:
    if purpose == "pile":
        small = wish.sized or (outcome.area <= _small(wish, garment) and outcome.slim > 0.3)
        return outcome.rectangular > 0.85 and small
    if purpose == "hang":
        return wish.sized or outcome.width < 0.6
    if purpose == "table":
        return wish.sized or outcome.area <= 0.55
    if purpose == "wear":
        return outcome.triangular > 0.85 and outcome.rectangular < 0.85
    return outcome.area <= {"bag": 0.34, "pocket": 0.3, "basket": 0.6}[purpose]
