"""An instruction to folds: by the folds that it describes, or by the end that it wishes for."""

from __future__ import annotations

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
        return understand(text, garment)
    except NotUnderstoodError:
        wish = read_wish(text, _called(garment), folds_named=True)
        if wish is None:
            raise
        return Meaning(tuple(folds_for_wish(wish, garment)), tuple(garment.notes))


def _called(garment: Garment) -> frozenset[str]:
    """What the garment on the table may be called."""
    return frozenset({"any", *_NAMES.get(garment.family, ()), garment.kind})
