"""An instruction to folds: by the folds that it describes, or by the end that it wishes for."""

from __future__ import annotations

from dataclasses import replace

from polyfold_llms.folding.granting import folds_for_wish
from polyfold_llms.folding.meaning import Meaning, understand
from polyfold_llms.folding.parts import Garment, NotUnderstoodError
from polyfold_llms.folding.wishes import read_wish

__all__ = ["plan"]

_NAMES = {"tshirt": ("tshirt",), "pants": ("pants",), "quad": ("cloth",)}


def plan(text: str, garment: Garment) -> Meaning:
    """The folds that an instruction asks for.

    Raises:
        NotUnderstoodError: with the reason.
    """
    wish = read_wish(text, _called(garment))
    if wish is not None:
        return Meaning(tuple(folds_for_wish(wish, garment)), tuple(garment.notes))
    try:
        return understand(_spelled_out(text, garment), garment)
    except NotUnderstoodError:
        wish = read_wish(text, _called(garment), folds_named=True)
        if wish is None:
            raise
        return Meaning(tuple(folds_for_wish(wish, garment)), tuple(garment.notes))


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
