"""An instruction to folds: by the folds that it describes, or by the end that it wishes for."""

from __future__ import annotations

import re
from dataclasses import replace

from polyfold_rules.clauses.meaning import Meaning, understand
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.wishes.granting import folds_for_wish
from polyfold_rules.wishes.reading import read_wish
from polyfold_rules.wishes.wish import Wish

_NAMES = {"tshirt": ("tshirt",), "pants": ("pants",), "quad": ("cloth",)}


def plan(text: str, garment: Garment) -> Meaning:
    """The folds that an instruction asks for.

    Raises:
        NotUnderstoodError: with the reason.
    """
    wish = read_wish(text, _called(garment))
    if wish is not None:
        return _granted(wish, garment)
    loose = read_wish(text, _called(garment), folds_named=True)
    ahead = replace(garment, folds=list(garment.folds), notes=[])
    if loose is None:
        if more := _MORE.search(text.lower()):
            raise NotUnderstoodError(f"folding makes nothing {more.group('more')}")
        return understand(_spelled_out(text, ahead), ahead)
    if loose.least or _LESS.search(text.lower()):
        return _granted(loose, garment)
    try:
        meaning = understand(_spelled_out(text, ahead), ahead)
    except NotUnderstoodError:
        return _granted(loose, garment)
    return _with_fewer_folds(meaning, loose, garment)


def _granted(wish: Wish, garment: Garment) -> Meaning:
    return Meaning(tuple(folds_for_wish(wish, garment)), tuple(garment.notes))


def _with_fewer_folds(meaning: Meaning, wish: Wish, garment: Garment) -> Meaning:
    """What the wish grants, if it asks for fewer folds than were understood: *fold it twice*."""
    if wish.steps is None or len(meaning.folds) <= wish.steps[1]:
        return meaning
    try:
        return _granted(wish, garment)
    except NotUnderstoodError:
        return meaning


_LESS = re.compile(r"\b(?:shorter|short)\b(?=[.,;!?]|$| please| like| than)")
_MORE = re.compile(
    r"\b(?:make|get|want|need|be|become|should|must|like)\b(?! not| no)(?: (?!not|no|any)[\w'-]+){0,4} "
    r"(?P<more>longer|wider|larger|bigger|taller|broader)(?= ?[.!?]|$| please)"
)
"""Sizes of the whole cloth: *short* and *long* name edges to the grammar of folds."""


def _spelled_out(text: str, garment: Garment) -> str:
    """*A quarter of its size: left over right, then bottom over top*: the part that tells the folds, if one does."""
    end, _, folds = text.partition(":")
    if not folds or read_wish(end, _called(garment)) is None:
        return text
    try:
        understand(folds, replace(garment, folds=[], notes=[]))
    except NotUnderstoodError:
        return text
    return folds


def _called(garment: Garment) -> frozenset[str]:
    """What the garment on the table may be called."""
    return frozenset({"any", *_NAMES.get(garment.family, ()), garment.kind})
