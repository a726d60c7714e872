"""One fold, and how it is said: *fold <part> <direction> to <part> <axis>*."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

EDGES = ("left", "right", "top", "bottom")
CORNERS = ("bottom_left", "top_left", "top_right", "bottom_right")
OPPOSITE_EDGE = {"left": "right", "right": "left", "top": "bottom", "bottom": "top", "long": "long", "short": "short"}
OPPOSITE_CORNER = {
    "bottom_left": "top_right", "top_right": "bottom_left", "top_left": "bottom_right", "bottom_right": "top_left",
}  # fmt: skip

_DIRECTION = {"left": "rightward", "right": "leftward", "top": "downward", "bottom": "upward"}
_EDGE_NAMES = {
    "tshirt": {"left": "left side", "right": "right side", "top": "shoulders", "bottom": "hem"},
    "pants": {"left": "left leg", "right": "right leg", "top": "waist", "bottom": "leg ends"},
}
_PART_OF_THE_REST = {
    "left": "left half", "right": "right half", "top": "upper edge", "bottom": "lower edge",
}  # fmt: skip
"""What moves where folded cloth is halved again: in other words than where it is flat."""

PART_NAMES = {3: "third", 4: "quarter", 5: "fifth", 6: "sixth", 8: "eighth"}
_NUMBERS = {2: "two", 3: "three"}
_AXIS = {"left": "vertical centre line", "right": "vertical centre line"}


@dataclass(frozen=True)
class Fold:
    """One fold.

    Attributes:
        action: ``half`` (edge onto the opposite edge), ``middle`` (edge to the middle line), ``band`` (a strip along
            an edge, ``share`` of the flat garment wide), ``corner`` or ``sleeve``.
        part: the edge (``left right top bottom``, or ``long``/``short``), corner or sleeve that moves.
        target: for corners ``centre`` or another corner.
        manner: ``straight`` or ``slanted`` for sleeves, ``gap`` for a half along a gap, ``again`` for a half of what
            is left after the same half.
        share: width of a band as a share of the flat garment.
        cm: width of a band [cm], where that is told instead.
    """

    action: str
    part: str
    target: str = ""
    manner: str = ""
    share: Fraction = Fraction(0)
    cm: float = 0.0


def edge_name(kind: str, edge: str) -> str:
    """What an edge is called on this kind of garment."""
    return _EDGE_NAMES.get(kind, {}).get(edge, f"{edge} edge")


def say(fold: Fold, kind: str) -> str:
    """The fold in the anchored form, precise enough to find its line."""
    if fold.action == "sleeve":
        axis = "the armhole" if fold.manner == "straight" else "the slanted line from the armpit to the neck"
        return f"fold the {fold.part} sleeve inward to the body along {axis}"
    if fold.action == "corner":
        corner = fold.part.replace("_", " ")
        if fold.target == "centre":
            return f"fold the {corner} corner inward to the centre"
        return f"fold the {corner} corner to the {fold.target.replace('_', ' ')} corner"
    if fold.action == "middle":
        return f"fold the {edge_name(kind, fold.part)} inward to the middle line"
    if fold.action == "band":
        return _say_band(fold)
    return _say_half(fold, kind)


def _say_band(fold: Fold) -> str:
    way = _DIRECTION[fold.part]
    if fold.cm:
        return f"fold the {fold.part} strip of {fold.cm:g} cm {way} to the rest"
    if fold.share.numerator == 1:
        name = PART_NAMES[fold.share.denominator]
        middle = "middle third" if name == "third" else "middle"
        return f"fold the {fold.part} {name} {way} to the {middle} along the {name} line"
    name = f"{_NUMBERS[fold.share.numerator]} {PART_NAMES[fold.share.denominator]}s"
    return f"fold the {fold.part} {name} {way} to the rest"


def _say_half(fold: Fold, kind: str) -> str:
    opposite = OPPOSITE_EDGE[fold.part]
    if fold.part in ("long", "short"):
        return f"fold one {fold.part} edge to the other {fold.part} edge along the centre line"
    direction = _DIRECTION[fold.part]
    axis = _AXIS.get(fold.part, "horizontal centre line")
    if fold.manner == "gap":
        return f"fold the {fold.part} half {direction} to the {opposite} half along the gap"
    part, target = edge_name(kind, fold.part), edge_name(kind, opposite)
    if fold.manner == "again":
        part = _PART_OF_THE_REST[fold.part]
    return f"fold the {part} {direction} to the {target} along the {axis}"
