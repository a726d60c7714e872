"""Programs to folds: what a sentence leaves open is settled as the prompt for subgoals says, and noted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from polyfold_offline.cloth.folds import CORNERS, EDGES, OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.goals import folds_for_goal
from polyfold_offline.meaning.program import Piece, Program

MAX_FOLDS = 8
MAX_HALVES = 4
"""Halving more often leaves a wad that no arm can grip."""

_EDGE = {"L": "left", "R": "right", "T": "top", "B": "bottom", "side": "left", "end": "bottom"}
_CORNER: dict[str, str] = dict(zip(("BL", "TL", "TR", "BR"), CORNERS, strict=True))

REASONS = {
    "action": "it asks for something else than folding; I only fold parts over onto the cloth",
    "garment": "it asks for something else than the {garment} on the table",
    "part": "it names a part that a {garment} does not have",
    "impossible": "a {garment} can't be folded like that",
    "contradiction": "it contradicts itself; say each fold once, and one place for each part",
    "nonsense": "it holds no folding instruction that I understand",
    "unclear": "it does not say clearly which part moves, or where to",
}


Length = float | Fraction
"""A length that a sentence names [cm], or, as a fraction, a share of the garment's side."""


@dataclass
class Folding:
    """Folds so far, and notes on what was left open.

    Attributes:
        garment: what lies on the table.
        lengths: the lengths that the sentence names, in their order.
        folds: in their order.
        notes: in words for the person.
    """

    garment: Garment
    lengths: Sequence[Length] = ()
    folds: list[Fold] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def note(self, text: str) -> None:
        """Remember a choice, once."""
        if text not in self.notes:
            self.notes.append(text)


def folds_of(program: Program, lengths: Sequence[Length], garment: Garment) -> Folding:
    """The folds that a program asks for.

    Args:
        program: what was read.
        lengths: the lengths that the sentence names.
        garment: what lies on the table.

    Raises:
        NotUnderstoodError: if it is a refusal, or can't be done on this garment.
    """
    folding = Folding(garment, lengths)
    first = program[0]
    if first.operation == "no":
        raise NotUnderstoodError(REASONS[first.place].format(garment=garment.spoken))
    if first.operation == "goal":
        folding.folds += folds_for_goal(first, size_of(program, lengths), garment)
        folding.note(f"Nothing is said about the folds; of the ways that I know, {len(folding.folds)} come nearest.")
    else:
        for piece in program:
            folding.folds.append(_STEPS[piece.operation](piece, folding))
    _check(folding.folds)
    return folding


def size_of(program: Program, lengths: Sequence[Length]) -> tuple[float, float] | None:
    """The size that a goal must fit in [cm], if the program names one.

    Raises:
        NotUnderstoodError: if the sentence names no such lengths.
    """
    fit = next((piece for piece in program if piece.operation == "fit"), None)
    return None if fit is None else (_length(fit.place, lengths, None), _length(fit.detail, lengths, None))


def _length(mark: str, lengths: Sequence[Length], side_cm: float | None) -> float:
    """A length that a sentence names [cm]; a share is one of a side, if that is known [cm]."""
    number = int(mark[1:])
    if number > len(lengths):
        raise NotUnderstoodError("it is unclear which length is meant")
    length = lengths[number - 1]
    if not isinstance(length, Fraction):
        return length
    if side_cm is None:
        raise NotUnderstoodError(f"I can't tell how much {length} of it is; say it in centimetres")
    return round(float(length) * side_cm, 1)


def _check(folds: list[Fold]) -> None:
    """Refuse what was most likely misread: one fold told twice, a fold and its mirror image, folds without end."""
    once = [(fold.action, fold.part) for fold in folds if fold.action in ("band", "middle", "sleeve")]
    ears = [(fold.part, fold.target) for fold in folds if fold.action == "corner"]
    if len(set(once)) < len(once) or len(set(ears)) < len(ears):
        raise NotUnderstoodError("it seems to ask for the same fold twice; name each fold once")
    for first, second in pairwise(folds):
        halves = first.action == second.action == "half" and first.part in EDGES
        if halves and second.part == OPPOSITE_EDGE[first.part]:
            raise NotUnderstoodError(f"it folds the {first.part} half over and then the {second.part} one; say which")
    if len(folds) > MAX_FOLDS:
        raise NotUnderstoodError(f"{len(folds)} folds are more than a piece of cloth can take")


# Steps ---------------------------------------------------------------------------------------------------------------


def _half(piece: Piece, folding: Folding) -> Fold:
    triangle = next((f for f in folding.folds if f.action == "corner" and f.target == OPPOSITE_CORNER[f.part]), None)
    if triangle is not None and piece.place in ("any", "side", "end"):
        return _halved_triangle(triangle, folding)
    halves = [fold for fold in folding.folds if fold.action == "half"]
    if len(halves) >= MAX_HALVES:
        raise NotUnderstoodError(f"cloth folded in half more than {MAX_HALVES} times is too thick to fold on")
    if piece.place in ("long", "short"):
        return Fold("half", piece.place)
    edge = _free_edge(folding) if piece.place == "any" else _EDGE[piece.place]
    if piece.place in ("any", "side", "end"):
        folding.note(f"The instruction leaves open which half moves; I take the {edge} one.")
    if any(_across(fold.part) == _across(edge) for fold in halves):
        return Fold("half", edge, manner="again")
    return Fold("half", edge, manner="gap" if _gap(folding, edge) else "")


def _across(edge: str) -> bool:
    return edge in ("left", "right")


def _gap(folding: Folding, edge: str) -> bool:
    """Whether both edges on this axis were folded to the middle, so that a half fold runs along their gap."""
    return {edge, OPPOSITE_EDGE[edge]} <= {fold.part for fold in folding.folds if fold.action == "middle"}


def _free_edge(folding: Folding) -> str:
    halves = [fold.part for fold in folding.folds if fold.action == "half"]
    for edge in ("left", "bottom"):
        if _gap(folding, edge):
            return edge
    bands = [fold.part for fold in folding.folds if fold.action == "band"]
    if folding.garment.family in ("tshirt", "pants"):
        return "bottom" if any(_across(edge) for edge in (*halves, *bands)) or _sleeves_in(folding) else "left"
    last = (*bands, *halves)[-1:]
    return "left" if last and not _across(last[0]) else "bottom"


def _sleeves_in(folding: Folding) -> bool:
    return sum(fold.action == "sleeve" for fold in folding.folds) == 2


def _halved_triangle(triangle: Fold, folding: Folding) -> Fold:
    if sum(fold.action == "corner" for fold in folding.folds) > 1:
        raise NotUnderstoodError("the triangle was folded in half already; a further half fold of it is not supported")
    corner = next(c for c in CORNERS if c not in (triangle.part, triangle.target))
    folding.note(
        f"The triangle in half: one acute corner goes onto the other; I take the {corner.replace('_', ' ')} one."
    )
    return Fold("corner", corner, OPPOSITE_CORNER[corner])


def _middle(piece: Piece, folding: Folding) -> Fold:
    return Fold("middle", _edge(piece, "middle", folding))


def _strip(piece: Piece, folding: Folding) -> Fold:
    edge = _edge(piece, "band", folding)
    if not piece.detail.startswith("#"):
        return Fold("band", edge, share=Fraction(piece.detail))
    size = folding.garment.size_cm
    side = None if size is None else size[0 if _across(edge) else 1]
    width = _length(piece.detail, folding.lengths, side)
    if width <= 0:
        raise NotUnderstoodError("a strip of no width can't be turned over")
    if side is not None and width >= side:
        raise NotUnderstoodError(f"a strip of {width:g} cm is wider than the {folding.garment.spoken}")
    return Fold("band", edge, cm=width)


def _edge(piece: Piece, action: str, folding: Folding) -> str:
    """The edge that is named, or the first that has not moved yet."""
    if piece.place != "any":
        return _EDGE[piece.place]
    moved = [fold.part for fold in folding.folds if fold.action == action]
    if moved and OPPOSITE_EDGE[moved[-1]] not in moved:
        return OPPOSITE_EDGE[moved[-1]]
    folding.note("The instruction leaves open which side moves; I take the left one.")
    return next(edge for edge in (*EDGES, "left") if edge not in moved)


def _centre(piece: Piece, folding: Folding) -> Fold:
    return Fold("corner", _corner(piece, folding), "centre")


def _opposite(piece: Piece, folding: Folding) -> Fold:
    corner = _corner(piece, folding)
    return Fold("corner", corner, OPPOSITE_CORNER[corner])


def _corner(piece: Piece, folding: Folding) -> str:
    if piece.place != "any":
        return _CORNER[piece.place]
    moved = {fold.part for fold in folding.folds if fold.action == "corner"}
    covered = {fold.target for fold in folding.folds if fold.action == "corner"}
    corner = next((c for c in CORNERS if c not in moved | covered), None)
    if corner is None:
        raise NotUnderstoodError("every corner is folded already; none is left")
    folding.note(f"The instruction leaves open which corner; I take the {corner.replace('_', ' ')} one.")
    return corner


def _sleeve(piece: Piece, folding: Folding) -> Fold:
    before = [fold for fold in folding.folds if fold.action == "sleeve"]
    side = _EDGE.get(piece.place) or ("right" if before and before[-1].part == "left" else "left")
    if piece.place == "any" and not before:
        folding.note("The instruction leaves open which sleeve; I take the left one.")
    manner = piece.detail
    if manner == "any":
        manner = before[-1].manner if before else "straight"
    return Fold("sleeve", side, manner=manner)


_STEPS = {
    "half": _half, "mid": _middle, "strip": _strip, "centre": _centre, "across": _opposite, "sleeve": _sleeve,
}  # fmt: skip
