"""Small looks ahead along the tokens that tell apart uses of the same word."""

from __future__ import annotations

from collections.abc import Sequence

from polyfold_rules.words.phrases import OPPOSITE, NounPhrase, starts_noun_phrase
from polyfold_rules.words.tokens import Token

SHAPES = ("triangle", "result")
"""Nouns that name a shape after *into* and *make*."""

LAYING = ("lay", "lie", "lying", "laid", "rest", "put", "plac", "set", "align", "point", "aim", "land", "stop")
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
    """``both sleeves in, first the right and then the left``: the order of what was named together, and where it ends.

    The phrase returned has one set of sides per part, in the order in which they are done.
    """
    if last is None or not (last.plural or last.number or last.quantity in ("both", "all", "each")):
        return None
    groups: list[set[str]] = []
    end, apart = at, True
    while end < len(tokens):
        token = tokens[end]
        if token.category == "side":
            if apart:
                groups.append(set())
            groups[-1].add(token.value)
            apart = False
        elif _names_again(token, last) or _goes_on(token, len(groups) == _members(last)):
            apart = True
        else:
            break
        end += 1
    while end < len(tokens) and tokens[end].is_("seq", "first", "then") and clause_ends(tokens, end + 1):
        end += 1
    if not _orders(groups, last) or not clause_ends(tokens, end):
        return None
    return NounPhrase(sides=tuple(frozenset(group) for group in groups)), end


def _members(last: NounPhrase) -> int:
    """How many parts of those named together an order must list."""
    return 4 if last.noun == "corner" and not last.sides and last.number != 2 else 2


def _names_again(token: Token, last: NounPhrase) -> bool:
    return token.category in ("pronoun", "quant") or token.is_("noun", last.noun or "")


def _goes_on(token: Token, complete: bool) -> bool:
    return token.category in ("seq", "join") and not (complete and token.value != "after")


def _orders(groups: Sequence[set[str]], last: NounPhrase) -> bool:
    """Whether the sides tell the members of what was named apart, each once."""
    if _members(last) == 4:
        return len(groups) == 4 and len({frozenset(group) for group in groups}) == 4
    if len(groups) != 2 or len(last.sides) > 1:
        return False
    known = set(last.sides[0]) if last.sides else set()
    first, second = (group - known for group in groups)
    return len(first) == len(second) == 1 and OPPOSITE[next(iter(first))] in second


def singled_out(several: NounPhrase, phrase: NounPhrase) -> bool:
    """``put the legs together by taking the right one over``: one of several that were named together."""
    many = several.plural or several.quantity in ("both", "all", "each") or len(several.sides) > 1
    return many and len(phrase.sides) == 1 and not phrase.plural and phrase.noun in (None, several.noun)
