"""What a noun phrase refers to on this kind of garment: a corner, an edge, a sleeve, the middle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from polyfold_rules.shapes.folds import CORNERS, EDGES, OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_rules.words.phrases import NounPhrase

WORDS = {
    "legends": "leg ends", "centre": "centre", "midline": "middle line", "waist": "waistband", "neck": "collar",
    "twothirds": "two thirds",
}  # fmt: skip
NOUNS = {
    "quad": {"corner", "edge", "half", "third", "quarter", "hem", "tip"},
    "tshirt": {"edge", "half", "third", "quarter", "sleeve", "cuff", "hem", "shoulder", "neck"},
    "pants": {"edge", "half", "third", "quarter", "leg", "cuff", "hem", "legends", "waist"},
    "other": {"edge", "half", "third", "quarter", "hem", "corner", "waist"},
}
"""Nouns that can move, by family."""

PLACES = {
    "centre",
    "midline",
    "body",
    "gap",
    "armhole",
    "armpit",
    "crotch",
    "diagonal",
    "triangle",
    "result",
    "rest",
    "crease",
    "detail",
}


class NotUnderstoodError(Exception):
    """The instruction can't be turned into folds; the message is the reason, in words for the person."""


@dataclass(frozen=True)
class Part:
    """A resolved part: ``what`` is corner, edge, band, sleeve, whole or a place; ``which`` says which one."""

    what: str
    which: str = ""
    share: float = 0.0


@dataclass
class Garment:
    """The garment on the table and what has been folded so far.

    Attributes:
        kind: its kind, ``tshirt``.
        family: ``quad``, ``tshirt``, ``pants`` or ``other``: which grammar of parts applies.
        folds: the folds already planned, in order.
        notes: choices made where the instruction left them open.
    """

    kind: str
    family: str
    folds: list[Fold] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def from_vertices(cls, kind: str, names: Iterable[str]) -> Garment:
        """Tell the family from the vertices' names."""
        names = set(names)
        if any("sleeve" in name for name in names):
            family = "tshirt"
        elif "crotch" in names:
            family = "pants"
        elif names & set(CORNERS):
            family = "quad"
        else:
            family = "other"
        return cls(kind, family)

    @property
    def spoken(self) -> str:
        """The kind in words."""
        return {"tshirt": "t-shirt", "pants": "pair of pants"}.get(self.kind, f"{self.kind.replace('_', ' ')} cloth")

    def last(self, action: str) -> Fold | None:
        """The last fold of this action."""
        return next((fold for fold in reversed(self.folds) if fold.action == action), None)

    def note(self, text: str) -> None:
        """Remember a choice."""
        if text not in self.notes:
            self.notes.append(text)


def resolve(phrase: NounPhrase, garment: Garment, role: str, context: NounPhrase | None = None) -> list[Part]:
    """The parts that a phrase names; an empty list for the whole garment.

    Raises:
        NotUnderstoodError: if this garment has no such part, or the phrase does not say which one.
    """
    noun = phrase.noun
    if noun is None and context is not None and (phrase.pronoun == "one" or phrase.quantity in ("other", "opposite")):
        noun = context.noun
    if noun is None and phrase.pronoun == "one" and not phrase.garments:
        noun = _kind_of_last(garment)
        if noun is None and phrase.sides and len(phrase.sides[0]) == 1:
            raise NotUnderstoodError(f"it is unclear which part “{phrase.text}” is; name it")
    if noun == "triangle" and garment.family == "quad" and not garment.folds and _two_sided(phrase):
        noun = "corner"
    if noun == "detail" and role != "axis":
        raise NotUnderstoodError(
            f"“{phrase.text}” is neither a part that I can fold nor a place; name a corner, an edge or the centre"
        )
    if noun in PLACES:
        return [
            Part(
                {"crease": "midline", "detail": "centre"}.get(noun, noun),
                next(iter(phrase.sides[0])) if phrase.sides else "",
            )
        ]
    if noun is None and not phrase.sides:
        if phrase.quantity in ("other", "opposite") and not phrase.garments:
            noun = _kind_of_last(garment)
        if noun is None:
            return []
    if noun is not None and noun not in NOUNS[garment.family] and not _target_only(noun, garment, role):
        raise NotUnderstoodError(f"a {garment.spoken} has no {WORDS.get(noun, noun)}")
    reader = _READERS[_reading(noun, phrase, garment)]
    return reader(phrase, garment, role, noun)


def _kind_of_last(garment: Garment) -> str | None:
    if not garment.folds:
        return None
    return {"sleeve": "sleeve", "corner": "corner"}.get(garment.folds[-1].action, "edge")


def _target_only(noun: str, garment: Garment, role: str) -> bool:
    return garment.family == "other" and role == "target"


def _reading(noun: str | None, phrase: NounPhrase, garment: Garment) -> str:
    if noun in ("sleeve", "cuff") and garment.family == "tshirt":
        return "sleeve"
    if noun in ("third", "quarter"):
        return "band"
    if noun in ("corner", "tip") or (_two_sided(phrase) and garment.family == "quad"):
        return "corner"
    return "edge"


def _two_sided(phrase: NounPhrase) -> bool:
    """Whether each group of sides tells a corner: *top left*."""
    return bool(phrase.sides) and all(len(group & set(EDGES)) == 2 for group in phrase.sides)


def _sleeves(phrase: NounPhrase, garment: Garment, role: str, noun: str | None) -> list[Part]:
    if phrase.number not in (None, 1, 2):
        raise NotUnderstoodError(f"a {garment.spoken} has two sleeves, not {phrase.number}")
    sides = [side for group in phrase.sides for side in sorted(group) if side in ("left", "right")]
    if sides:
        return [Part("sleeve", side) for side in sides]
    last = garment.last("sleeve")
    if phrase.quantity in ("other", "opposite"):
        if last is None:
            raise NotUnderstoodError("it is unclear which sleeve “the other” is, since none was folded before")
        return [Part("sleeve", OPPOSITE_EDGE[last.part])]
    if phrase.plural or phrase.quantity in ("all", "both", "each") or phrase.number == 2:
        return [Part("sleeve", "left"), Part("sleeve", "right")]
    garment.note("The instruction leaves open which sleeve; I take the left one.")
    return [Part("sleeve", "left")]


def _corners(phrase: NounPhrase, garment: Garment, role: str, noun: str | None) -> list[Part]:
    if garment.family != "quad":
        raise NotUnderstoodError(f"I know no way to fold a single corner of a {garment.spoken}")
    found: list[str] = []
    for group in phrase.sides:
        sides = group - {"long", "short"}
        found += [corner for corner in CORNERS if sides and sides <= set(corner.split("_"))]
    if found:
        one = len(phrase.sides) == 1 and len(phrase.sides[0]) == 1 and not phrase.plural and not phrase.quantity
        if one and phrase.number in (None, 1) and len(found) > 1:
            raise NotUnderstoodError(
                f"“{phrase.text}” could be either of two corners; say left or right, top or bottom"
            )
        return [Part("corner", corner) for corner in found]
    return [Part("corner", corner) for corner in _unsided_corners(phrase, garment, role)]


def _unsided_corners(phrase: NounPhrase, garment: Garment, role: str) -> list[str]:
    moved = [fold.part for fold in garment.folds if fold.action == "corner"]
    left = [corner for corner in CORNERS if corner not in moved]
    if not left:
        raise NotUnderstoodError("every corner is folded already; none is left")
    last = moved[-1] if moved else None
    if phrase.quantity == "opposite":
        if phrase.number == 2 or phrase.plural:
            garment.note("The instruction leaves open which two opposite corners; I take bottom left and top right.")
            return ["bottom_left", "top_right"]
        if role == "target":
            return ["opposite"]
        if last is not None:
            return [OPPOSITE_CORNER[last]]
        raise NotUnderstoodError("it is unclear which corner is opposite to which")
    if phrase.quantity == "adjacent":
        garment.note("The instruction leaves open which two neighbouring corners; I take the bottom ones.")
        return ["bottom_left", "bottom_right"]
    if phrase.quantity == "other":
        acute = [corner for corner in left if last is None or corner != OPPOSITE_CORNER[last]]
        if phrase.number == 2 and len(moved) == 1 and garment.folds[-1].target == OPPOSITE_CORNER[moved[0]]:
            return acute
        if phrase.plural or phrase.number or len(left) == 1:
            if phrase.number not in (None, 1, len(left)):
                raise NotUnderstoodError(f"{len(left)} corners are left, not {phrase.number}")
            if phrase.number == 1 and len(left) != 1:
                garment.note(f"The instruction leaves open which corner comes next; I take the {left[0]} one.")
                return left[:1]
            return left
        if role == "target":
            return ["opposite"]
        raise NotUnderstoodError("it is unclear which of the other corners is meant; say left or right, top or bottom")
    if phrase.number == 4 or phrase.quantity in ("all", "each") or (phrase.plural and phrase.number is None):
        return list(CORNERS)
    if phrase.number == 2 and last is not None and OPPOSITE_CORNER[last] not in moved:
        return [corner for corner in CORNERS if corner not in (last, OPPOSITE_CORNER[last])]
    if phrase.number == 1 or phrase.quantity == "one" or (not phrase.plural and phrase.number is None):
        garment.note(f"The instruction leaves open which corner; I take the {left[0].replace('_', ' ')} one.")
        return left[:1]
    raise NotUnderstoodError("it does not say which corners; say left or right, top or bottom")


def _edges(phrase: NounPhrase, garment: Garment, role: str, noun: str | None) -> list[Part]:
    fixed = _fixed_edge(noun, garment)
    if fixed:
        if noun == "shoulder" and phrase.sides and role in ("moving", "target"):
            return [Part("edge", side) for group in phrase.sides for side in sorted(group) if side in EDGES]
        single = len(phrase.sides) == 1 and bool(phrase.sides[0] & {"left", "right"})
        if noun in ("legends", "hem", "cuff") and garment.family == "pants" and single and role == "moving":
            raise NotUnderstoodError("a straight fold takes both leg ends along; one leg can't be folded up on its own")
        return [Part("edge", fixed)]
    if phrase.number is not None and phrase.number > (2 if noun == "leg" else 4):
        raise NotUnderstoodError(f"a {garment.spoken} does not have {phrase.number} of these")
    if noun == "leg" and not phrase.sides and phrase.quantity not in ("other", "opposite"):
        if phrase.plural or phrase.quantity or phrase.number == 2:
            return [Part("edge", "left"), Part("edge", "right")]
        garment.note("The instruction leaves open which leg; I take the left one.")
        return [Part("edge", "left")]
    found: list[str] = []
    for group in phrase.sides:
        sides = sorted(group & set(EDGES)) or sorted(group)
        if len(sides) != 1:
            raise NotUnderstoodError(f"“{phrase.text}” names two edges at once; name one, or a corner")
        found += sides
    if found:
        return [Part("edge", side) for side in found]
    return _unsided_edges(phrase, garment, role)


def _unsided_edges(phrase: NounPhrase, garment: Garment, role: str) -> list[Part]:
    triangle = garment.folds[-1] if len(garment.folds) == 1 and garment.folds[0].action == "corner" else None
    if triangle is not None and phrase.number == 2 and triangle.target == OPPOSITE_CORNER[triangle.part]:
        return [Part("corner", corner) for corner in CORNERS if corner not in (triangle.part, triangle.target)]
    last = next((fold for fold in reversed(garment.folds) if fold.action in ("half", "middle", "band")), None)
    if phrase.quantity == "opposite" and phrase.number == 2:
        garment.note("The instruction leaves open which two opposite edges; I take left and right.")
        return [Part("edge", "left"), Part("edge", "right")]
    if phrase.quantity in ("other", "opposite"):
        if phrase.plural and last is not None and last.action == "middle":
            remaining = [e for e in EDGES if e not in {fold.part for fold in garment.folds}]
            if phrase.number == len(remaining):
                return [Part("edge", edge) for edge in remaining]
        if role == "target":
            return [Part("edge", "opposite")]
        if last is not None:
            return [Part("edge", OPPOSITE_EDGE[last.part])]
        raise NotUnderstoodError("it is unclear which edge “the other” is, since none was named before")
    if phrase.number == 4 or (phrase.quantity in ("all", "each") and phrase.number is None):
        return [Part("edge", edge) for edge in EDGES]
    if phrase.number == 2 or phrase.quantity == "both" or phrase.plural:
        return [Part("edge", "left"), Part("edge", "right")]
    return [Part("edge", "any")]


def _fixed_edge(noun: str | None, garment: Garment) -> str | None:
    if noun == "hem" and garment.family == "quad":
        return None
    return {
        "hem": "bottom",
        "legends": "bottom",
        "cuff": "bottom",
        "waist": "top",
        "shoulder": "top",
        "neck": "top",
    }.get(noun or "")


def _bands(phrase: NounPhrase, garment: Garment, role: str, noun: str | None) -> list[Part]:
    share = {"third": 1 / 3, "quarter": 0.25}[noun or "third"]
    sides = [side for group in phrase.sides for side in sorted(group) if side in EDGES]
    if not sides and phrase.quantity in ("other", "opposite"):
        last = garment.last("band")
        if last is not None:
            sides = [OPPOSITE_EDGE[last.part]]
        elif role == "target":
            return [Part("centre")]
    if not sides and role != "moving":
        return [Part("centre" if role == "target" else "line")]
    if not sides:
        raise NotUnderstoodError(f"it does not say which {noun}; say left, right, top or bottom")
    return [Part("band", side, share) for side in sides]


_Reader = Callable[[NounPhrase, Garment, str, str | None], list[Part]]
_READERS: Mapping[str, _Reader] = {"sleeve": _sleeves, "corner": _corners, "edge": _edges, "band": _bands}
