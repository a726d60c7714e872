"""Noun phrases: which part of the cloth is named, on which sides, how many, and by what kind of reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from polyfold_rules.words.tokens import Token

OPPOSITE = {"left": "right", "right": "left", "top": "bottom", "bottom": "top", "long": "short", "short": "long"}
COMPOUND = {"edge", "tip", "half", "crease", "body", "hem", "result", "armhole", "corner"}
"""Nouns that may follow another part's name without changing what is meant: *sleeve end*, *waist edge*."""
BANDS = {"waist": "top", "hem": "bottom", "legends": "bottom", "neck": "top", "shoulder": "top"}
"""Parts that tell which third or quarter is meant: *the waist third*."""


@dataclass(frozen=True)
class NounPhrase:
    """One mention of a part.

    Attributes:
        noun: the part's name in the lexicon, or None for a bare side (*the left*).
        sides: one set of sides per member of a list: *bottom left and top right corners* has two.
        quantity: ``all``, ``both``, ``each``, ``other``, ``opposite``, ``one``, ``same`` or None.
        number: a stated number.
        plural: the noun stands in the plural.
        pronoun: ``it``, ``them`` or ``one``.
        garments: garments mentioned along the way.
        text: the words.
    """

    noun: str | None = None
    sides: tuple[frozenset[str], ...] = ()
    quantity: str | None = None
    number: int | None = None
    plural: bool = False
    pronoun: str | None = None
    garments: tuple[str, ...] = ()
    text: str = ""

    @property
    def names_it(self) -> bool:
        """Whether anything but a quantity is said."""
        return bool(self.noun or self.sides or self.pronoun or self.garments)

    @property
    def names_part(self) -> bool:
        """Whether a particular part is meant, not the whole garment or a pronoun."""
        return bool(self.noun or self.sides or (self.quantity and not self.garments and self.pronoun != "it"))


def starts_noun_phrase(tokens: Sequence[Token], at: int) -> bool:
    """Whether a noun phrase begins here."""
    if at >= len(tokens):
        return False
    return tokens[at].category in ("side", "noun", "garment", "quant", "pronoun") or (
        tokens[at].category == "number" and starts_noun_phrase(tokens, at + 1)
    )


def noun_phrase(tokens: Sequence[Token], at: int) -> tuple[NounPhrase, int]:
    """Read the noun phrase at ``at``; returns it and the place after it."""
    start = at
    found = NounPhrase()
    group: set[str] = set()
    groups: list[frozenset[str]] = []
    while at < len(tokens):
        token = tokens[at]
        if token.category == "side":
            listed = found.noun == "corner" and not found.sides and (found.plural or len(group) == 1)
            taken = OPPOSITE[token.value] in group or token.value in group
            if (found.noun and not listed) or found.pronoun or taken:
                break
            group.add(token.value)
        elif token.is_("quant", "opposite") and found.noun and not found.quantity:
            found = replace(found, quantity="opposite")
        elif token.category in ("quant", "number"):
            if found.noun or (token.category == "number" and found.number is not None):
                break
            found = _counted(found, token)
        elif token.category == "noun":
            if found.noun in BANDS and token.value in ("third", "quarter"):
                found, group = replace(found, noun=token.value), {BANDS[found.noun]}
                at += 1
                continue
            if found.noun and token.value not in COMPOUND:
                break
            found = _named(found, token)
        elif token.category == "garment":
            if found.noun or found.garments:
                break
            found = replace(found, garments=(*found.garments, token.value), plural=found.plural)
        elif token.category == "pronoun":
            if token.value == "one" and starts_noun_phrase(tokens, at + 1) and not group and not found.quantity:
                found = replace(found, number=1)
                at += 1
                continue
            if token.value == "one" and not (group or found.quantity) and at + 1 < len(tokens):
                partitive = tokens[at + 1].is_("prep", "of") and starts_noun_phrase(tokens, at + 2)
                if partitive:
                    found = replace(found, number=1)
                    at += 2
                    continue
            if token.value == "one" and found.quantity and at + 1 < len(tokens) and tokens[at + 1].is_("prep", "of"):
                at += 2
                continue
            if found.noun or found.garments:
                break
            found = replace(found, pronoun=token.value, plural=found.plural or token.text == "ones")
            at += 1
            break
        elif token.category == "join" and group and (_list_goes_on(found, tokens, at)):
            groups.append(frozenset(group))
            group = set()
            while tokens[at].category != "side":
                at += 1
            continue
        elif token.is_("prep", "of") and (found.quantity or found.number) and not (found.noun or group):
            pass
        else:
            break
        at += 1
    if group:
        groups.append(frozenset(group))
    found = replace(found, sides=tuple(groups))
    found, at = _attachments(found, tokens, at)
    return replace(found, text=" ".join(token.text for token in tokens[start:at])), at


def _counted(found: NounPhrase, token: Token) -> NounPhrase:
    if token.category == "number":
        return replace(found, number=int(token.value))
    if token.text == "others":
        return replace(found, quantity="other", plural=True)
    return replace(found, quantity=token.value if found.quantity in (None, "all", "both", "one") else found.quantity)


def _named(found: NounPhrase, token: Token) -> NounPhrase:
    if found.noun:
        return replace(found, plural=found.plural or token.plural)
    return replace(found, noun=token.value, plural=token.plural and found.number != 1)


def _list_goes_on(found: NounPhrase, tokens: Sequence[Token], at: int) -> bool:
    """``the left and right sleeves``, ``the corners bottom left and top left``."""
    if tokens[at].value == "or":
        return False
    if not found.noun:
        return _side_follows(tokens, at) and not _another_part(tokens, at)
    return found.noun == "corner" and found.plural and at + 1 < len(tokens) and tokens[at + 1].category == "side"


def _side_follows(tokens: Sequence[Token], at: int) -> bool:
    """Whether a list of sides goes on: ``left and right sleeves``."""
    at += 1
    while at < len(tokens) and tokens[at].is_("join"):
        at += 1
    if at >= len(tokens) or tokens[at].category != "side":
        return False
    while at < len(tokens) and tokens[at].category in ("side", "join"):
        at += 1
    return at < len(tokens) and tokens[at].category == "noun"


def _another_part(tokens: Sequence[Token], at: int) -> bool:
    """``left over right, bottom third up``: sides that name two parts, one each, are no list."""
    ahead = at
    while tokens[ahead].category in ("side", "join"):
        ahead += 1
    if not any(token.is_("join", "and") for token in tokens[at:ahead]):
        return not tokens[ahead].plural
    first = sum(token.category == "side" for token in tokens[max(0, at - 2) : at])
    last = sum(token.category == "side" for token in tokens[max(at, ahead - 2) : ahead])
    if first < last and not tokens[ahead].plural:
        return True
    sides = {token.value for token in tokens[at - 1 : ahead] if token.category == "side"}
    crossed = bool(sides & {"left", "right"}) and bool(sides & {"top", "bottom"})
    single = tokens[at - 1].category == "side" and (at < 2 or tokens[at - 2].category != "side")
    return crossed and single and tokens[ahead].value in ("third", "quarter", "half")


def _attachments(found: NounPhrase, tokens: Sequence[Token], at: int) -> tuple[NounPhrase, int]:
    """``of the shirt``, ``of the left sleeve``, ``on the left``, ``at the bottom right``."""
    while at + 1 < len(tokens):
        token = tokens[at]
        if token.is_("prep", "of") and starts_noun_phrase(tokens, at + 1):
            inner, at = noun_phrase(tokens, at + 1)
            found = _part_of(found, inner)
        elif tokens[at + 1].category == "side" and _locates(found, token):
            inner, after = noun_phrase(tokens, at + 1)
            if inner.noun not in (None, "edge") or len(inner.sides) != 1 or not _may_place(found, inner.sides[0]):
                break
            merged = (found.sides[0] | inner.sides[0]) if found.sides else inner.sides[0]
            found, at = replace(found, sides=(merged,)), after
        else:
            break
    return found, at


def _locates(found: NounPhrase, token: Token) -> bool:
    """Whether a preposition can begin *on the left*, *at the bottom*, *along the top edge*."""
    if token.category != "prep":
        return False
    return token.text in ("in", "at", "on") or (token.text == "along" and found.noun == "corner" and not found.sides)


def _may_place(found: NounPhrase, sides: frozenset[str]) -> bool:
    """Whether ``on the left`` tells which part is meant, rather than where it goes."""
    if found.noun in ("centre", "midline", "gap") or not (found.noun or found.pronoun == "one"):
        return False
    if not found.sides:
        return True
    have = found.sides[0]
    return found.noun == "corner" and len(have) == 1 and not any(OPPOSITE[s] in have or s in have for s in sides)


def _part_of(outer: NounPhrase, inner: NounPhrase) -> NounPhrase:
    garments = (*outer.garments, *inner.garments)
    if outer.noun == "corner" and inner.noun == "edge" and len(inner.sides) == 1 and len(outer.sides) < 2:
        return replace(outer, sides=(frozenset().union(*outer.sides, *inner.sides),), garments=garments)
    if outer.noun == "edge" and outer.plural and inner.noun == "diagonal":
        return replace(outer, noun="corner", quantity="opposite", number=2, garments=garments)
    share = outer.noun in ("half", "third", "quarter")
    if share and (inner.noun == "sleeve" or (inner.noun == "leg" and inner.sides)):
        return replace(outer, noun="detail", garments=garments)
    if outer.noun == "centre" and inner.noun in ("edge", "sleeve", "leg", "hem", "waist"):
        return replace(outer, noun="detail", garments=garments)
    if inner.noun is None or outer.noun in (
        "centre",
        "midline",
        "gap",
        "third",
        "quarter",
        "corner",
        "half",
        "diagonal",
    ):
        if outer.noun is None and not outer.sides and inner.sides:
            return replace(outer, sides=inner.sides, garments=garments)
        return replace(outer, garments=garments)
    sides = outer.sides[0] if outer.sides else frozenset()
    if inner.noun == "leg" and (outer.noun in (None, "edge", "cuff", "hem", "tip")):
        if "top" in sides:
            return replace(inner, noun="waist", sides=(), garments=garments)
        return replace(inner, noun="legends", garments=garments)
    if inner.noun in ("sleeve", "cuff", "hem", "waist", "shoulder", "neck"):
        return replace(
            inner, sides=inner.sides or outer.sides, garments=garments, quantity=inner.quantity or outer.quantity
        )
    return replace(outer, garments=garments)
