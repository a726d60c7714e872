"""What a program leaves open: whether given folds are one of the ways to carry it out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from polyfold_offline.cloth.folds import Fold
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.folding import Length, folds_of, size_of
from polyfold_offline.meaning.goals import demands, folds_for_goal
from polyfold_offline.meaning.outcomes import outcomes
from polyfold_offline.meaning.program import CORNERS, EDGES, Piece, Program, places_of

LEFT_OPEN = {"side": ("L", "R"), "end": ("T", "B"), "any": (*EDGES, *CORNERS)}
"""Places that a word of a program stands for, whatever the operation."""

_CODES = {
    "left": "L", "right": "R", "top": "T", "bottom": "B",
    "bottom_left": "BL", "top_left": "TL", "top_right": "TR", "bottom_right": "BR",
}  # fmt: skip


def allowance(program: Program, lengths: Sequence[Length], garment: Garment, folds: Sequence[Fold]) -> float:
    """How far these folds are one way to do what a program asks for, 0 to 1.

    Args:
        program: what was read.
        lengths: the lengths that the sentence names.
        garment: what lies on the table.
        folds: the folds in question, in their order.

    Returns:
        1 if they are, 0 if they are not, and between them where a wish takes fewer folds.
    """
    if program[0].operation == "goal":
        return _wished(program, lengths, garment, folds)
    if program[0].operation == "no" or len(program) != len(folds):
        return 0.0
    settled = tuple(_settled(piece, fold, garment) for piece, fold in zip(program, folds, strict=True))
    try:
        return float(folds_of(settled, lengths, garment).folds == list(folds))
    except NotUnderstoodError:
        return 0.0


def _settled(piece: Piece, fold: Fold, garment: Garment) -> Piece:
    """The piece with what it leaves open settled as the fold has it."""
    code = _CODES.get(fold.part, "")
    if code in LEFT_OPEN.get(piece.place, ()) and code in places_of(garment.family, piece.operation):
        piece = replace(piece, place=code)
    if piece.operation == "sleeve" and piece.detail == "any" and fold.manner:
        piece = replace(piece, detail=fold.manner)
    return piece


_OTHER_WAY = 0.9
"""How far another end of as many folds is meant than the wish itself would take."""

_LABOURED = 0.5
"""How far an end is meant that takes more folds than a wish needs: a triangle in half is a triangle too."""


def _wished(program: Program, lengths: Sequence[Length], garment: Garment, folds: Sequence[Fold]) -> float:
    end = next((outcome for outcome in outcomes(garment.family) if outcome.folds == tuple(folds)), None)
    if end is None:
        return 0.0
    try:
        size = size_of(program, lengths)
        if not all(content(end) for _, content in demands(program[0], size, garment)):
            return 0.0
        chosen = folds_for_goal(program[0], size, garment)
        return 1.0 if chosen == list(folds) else _OTHER_WAY if len(chosen) == len(folds) else _LABOURED
    except NotUnderstoodError:
        return 0.0
