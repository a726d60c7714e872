"""An instruction to folds: by the folds that it describes, or by the end that it wishes for."""

from __future__ import annotations

import re
from dataclasses import replace

from polyfold_rules.clauses.meaning import Meaning, understand
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.wishes.granting import folds_for_wish
from polyfold_rules.wishes.wish import Wish
from polyfold_rules.wishes.wishes import read_wish

_NAMES = {"tshirt": ("tshirt",), "pants": ("pants",), "quad": ("cloth",)}


def plan(text: str, garment: Garment) -> Meaning:
    """The folds that an instruction asks for.

    Raises:
        NotUnderstoodError: with the reason.
    """
    wish = read_wish(text, _called(garment))
    if wish is not None:
        return Meaning(tuple(folds_for_wish(wish, garment)), tuple(garment.notes))
    utmost = read_wish(text, _called(garment), folds_named=True)
    if utmost is not None and (utmost.least or _LESS.search(text.lower())):
        return Meaning(tuple(folds_for_wish(utmost, garment)), tuple(garment.notes))
    if utmost is None and (more := _MORE.search(text.lower())) is not None:
        raise NotUnderstoodError(f"folding makes nothing {more.group('more')}")
    ahead = replace(garment, folds=list(garment.folds), notes=[])
    try:
        meaning = understand(_spelled_out(text, ahead), ahead)
    except NotUnderstoodError:
        if utmost is None:
            raise
        meaning = None
    if meaning is not None and not _too_many(meaning, utmost):
        return meaning
    try:
        return Meaning(tuple(folds_for_wish(utmost, garment)), tuple(garment.notes))
    except NotUnderstoodError:
        if meaning is None:
            raise
        return meaning


_LESS = re.compile(r"\b(?:shorter|short)\b(?=[.,;!?]|$| please| like| than)")
_MORE = re.compile(
    r"\b(?:make|get|want|need|be|become|should|must|like)\b(?! not| no)(?: (?!not|no|any)[\w'-]+){0,4} "
    r"(?P<more>longer|wider|larger|bigger|taller|broader)(?= ?[.!?]|$| please)"
)
"""Sizes of the whole cloth: *short* and *long* name edges to the grammar of folds."""


def _too_many(meaning: Meaning, wish: Wish | None) -> bool:
    """Whether a wish that the whole sentence can be read as asks for fewer folds than these: *fold it twice*."""
    return wish is not None and wish.steps is not None and len(meaning.folds) > wish.steps[1]


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
