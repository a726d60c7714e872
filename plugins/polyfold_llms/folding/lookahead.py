"""Small looks ahead along the tokens that tell apart uses of the same word."""

from __future__ import annotations

from collections.abc import Sequence

from polyfold_llms.folding.phrases import OPPOSITE, NounPhrase, starts_noun_phrase
from polyfold_llms.folding.tokens import Token

__all__ = [
    "LAYING",
    "LINES",
    "SEAMS",
    "SHAPES",
    "SPANS",
    "clause_ends",
    "described",
    "is_centre",
    "keeps_manner",
    "order_list",
    "side_before_side",
    "verb_ahead",
]

SHAPES = ("triangle", "result")
"""Nouns that name a shape after *into* and *make*."""

LAYING = ("lay", "lie", "lying", "laid", "rest", "put", "plac", "set", "align")
"""Beginnings of verbs after which *along* and *at* tell where something goes, not where the crease runs."""

SPANS = (
    "runs",
    "running",
    "run",
    "going",
    "goes",
    "extending",
    "extends",
    "leading",
    "leads",
    "drawn",
    "joins",
    "connects",
    "links",
)
"""Verbs by which a line is described: *the diagonal that runs from ... to ...*."""

LINES = ("crease", "diagonal", "midline", "gap", "third", "quarter")
"""Nouns of lines, which what follows directly describes."""

SEAMS = ("armpit", "armhole", "crotch")
"""Nouns that lie on creases and never move on their own."""


def clause_ends(tokens: Sequence[Token], at: int) -> bool:
    """Whether a clause ends here."""
    return at >= len(tokens) or tokens[at].category in ("stop", "join", "seq", "but")


def keeps_manner(tokens: Sequence[Token], at: int) -> bool:
    """``keeping it level``."""
    while at < len(tokens) and tokens[at].category == "pronoun":
        at += 1
    return at < len(tokens) and tokens[at].category == "manner"


def described(tokens: Sequence[Token], at: int) -> bool:
    """``to the horizontal centre line``: a manner before the noun phrase."""
    return at + 1 < len(tokens) and tokens[at + 1].category == "manner" and starts_noun_phrase(tokens, at + 2)


def side_before_side(tokens: Sequence[Token], at: int) -> bool:
    """``left before right``."""
    return (
        at + 2 < len(tokens)
        and tokens[at].category == tokens[at + 2].category == "side"
        and tokens[at + 1].text == "before"
    )


def verb_ahead(tokens: Sequence[Token], at: int) -> bool:
    """Whether a verb, or what leads up to one, stands here."""
    return at < len(tokens) and tokens[at].category in ("verb", "neg", "only", "again")


def is_centre(tokens: Sequence[Token], at: int) -> bool:
    """Whether the centre is named here."""
    return tokens[at].is_("noun", "centre", "midline")


def order_list(tokens: Sequence[Token], at: int, last: NounPhrase | None) -> tuple[NounPhrase, int] | None:
    """``both sleeves in, first the right and then the left``: the order of what was named together."""
    if last is None or last.sides or not (last.plural or last.quantity in ("both", "all", "each")):
        return None
    end = at
    sides = []
    while end < len(tokens) and tokens[end].category != "stop":
        token = tokens[end]
        if token.category == "side":
            sides.append(token.value)
        elif not (token.category in ("seq", "join", "pronoun", "quant") or token.is_("noun", last.noun or "")):
            break
        end += 1
        if len(sides) == 2:
            break
    if len(sides) != 2 or sides[1] != OPPOSITE[sides[0]]:
        return None
    while end < len(tokens) and (tokens[end].category in ("pronoun",) or tokens[end].is_("noun", last.noun or "")):
        end += 1
    return NounPhrase(sides=(frozenset({sides[0]}),)), end
