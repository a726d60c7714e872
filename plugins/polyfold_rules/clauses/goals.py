"""Requests that name a result instead of folds: *in half*, *into a block*, *tidy it*, *a quarter of its size*."""

from __future__ import annotations

from polyfold_rules.shapes.folds import CORNERS, OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError

MAX_HALVES = 4
"""Halving more often leaves a wad that no arm can grip."""

TIDY = ("block", "tidy", "store", "rectangle", "square", "default")


def fold_in_half(garment: Garment, edge: str | None = None, chosen: str = "") -> Fold:
    """The next half fold; ``edge`` is the edge that moves, if the instruction says it."""
    triangle = _triangle(garment)
    if triangle is not None and edge is None:
        return _triangle_in_half(garment, triangle)
    halves = [fold for fold in garment.folds if fold.action == "half"]
    if len(halves) >= MAX_HALVES:
        raise NotUnderstoodError(f"cloth folded in half more than {MAX_HALVES} times is too thick to fold on")
    if edge in (None, "any"):
        edge = _free_edge(garment)
        garment.note(f"The instruction leaves open which half moves; I take the {edge} one.")
    manner = "gap" if gap_open(garment, edge) else ""
    if any(_axis(fold.part) == _axis(edge) for fold in halves):
        manner = "again"
    return Fold("half", edge, manner=manner)


def gap_open(garment: Garment, edge: str) -> bool:
    """Whether both edges on this axis were folded to the middle, so that a half fold runs along their gap."""
    return {edge, OPPOSITE_EDGE[edge]} <= {fold.part for fold in garment.folds if fold.action == "middle"}


def _axis(edge: str) -> str:
    return "x" if edge in ("left", "right") else "y"


def _triangle(garment: Garment) -> Fold | None:
    return next((f for f in garment.folds if f.action == "corner" and f.target == OPPOSITE_CORNER[f.part]), None)


def _triangle_in_half(garment: Garment, triangle: Fold) -> Fold:
    used = [f for f in garment.folds if f.action == "corner"]
    if len(used) > 1:
        raise NotUnderstoodError("the triangle was folded in half already; a further half fold of it is not supported")
    corner = next(c for c in CORNERS if c not in (triangle.part, triangle.target))
    garment.note(
        f"The triangle in half: one acute corner goes onto the other; I take the {corner.replace('_', ' ')} one."
    )
    return Fold("corner", corner, OPPOSITE_CORNER[corner])


def _free_edge(garment: Garment) -> str:
    halves = [fold.part for fold in garment.folds if fold.action == "half"]
    for edge in ("left", "bottom"):
        if gap_open(garment, edge):
            return edge
    if garment.family in ("tshirt", "pants"):
        return "bottom" if any(_axis(edge) == "x" for edge in halves) else "left"
    if not halves:
        return "bottom"
    return "left" if _axis(halves[-1]) == "y" else "bottom"


def fold_in_fraction(garment: Garment, fraction: str, edge: str | None = None) -> list[Fold]:
    """Folds for *in thirds*, *in quarters*, *in eighths*; *in half* is :func:`fold_in_half`."""
    if fraction == "third":
        return _in_thirds(garment, edge)
    if fraction == "quarter" and garment.kind == "square" and not garment.folds:
        garment.note("A quarter of a square: a triangle, then the triangle in half.")
        return _repeat(garment, 2, first=Fold("corner", "bottom_left", "top_right"))
    done = sum(fold.action == "half" for fold in garment.folds)
    wanted = {"half": 1, "quarter": 2, "eighth": 3}[fraction]
    return _repeat(garment, max(1, wanted - done) if wanted > 1 else 1)


def _in_thirds(garment: Garment, edge: str | None) -> list[Fold]:
    folds: list[Fold] = []
    if edge in ("long", "short") and garment.family != "pants":
        raise NotUnderstoodError(f"I can't tell which edges are the {edge} ones; say left, right, top or bottom")
    if garment.family == "pants":
        if not any(fold.part in ("left", "right") for fold in garment.folds):
            folds.append(fold_in_half(garment, "left"))
            garment.note("Pants in thirds: legs together first.")
        edge = "bottom"
    elif edge in (None, "any"):
        edge = "left" if garment.family == "tshirt" else "bottom"
        garment.note(f"The instruction leaves open which way the thirds run; I begin with the {edge} third.")
    return [*folds, Fold("band", edge, share=1 / 3), Fold("band", OPPOSITE_EDGE[edge], share=1 / 3)]


def _repeat(garment: Garment, times: int, first: Fold | None = None) -> list[Fold]:
    folds: list[Fold] = []
    ahead = Garment(garment.kind, garment.family, list(garment.folds), garment.notes)
    for index in range(times):
        fold = first if index == 0 and first is not None else fold_in_half(ahead)
        folds.append(fold)
        ahead.folds.append(fold)
    return folds


def fold_for_goal(garment: Garment, goal: str, steps: int | None) -> list[Fold]:
    """Folds that reach a named result from what has been folded so far; ``steps`` if a number was asked for."""
    if steps is not None and not 1 <= steps <= MAX_HALVES:
        raise NotUnderstoodError(f"I know no way to fold a {garment.spoken} in {steps} steps")
    recipe = {"tshirt": _tshirt, "pants": _pants, "quad": _quad}.get(garment.family, _quad)
    folds = recipe(garment, goal, steps)
    if not folds:
        raise NotUnderstoodError(f"the {garment.spoken} is folded that way already; nothing is left to do")
    return folds


def _tshirt(garment: Garment, goal: str, steps: int | None) -> list[Fold]:
    if goal == "strip":
        return [fold_in_half(garment, "left")]
    if goal not in TIDY:
        raise NotUnderstoodError(f"I know no way to fold a t-shirt into a {goal}")
    if steps in (1, 2):
        return _repeat(garment, steps)
    done = {fold.part for fold in garment.folds if fold.action == "sleeve"}
    folds = [Fold("sleeve", side, manner="straight") for side in ("left", "right") if side not in done]
    if not any(fold.action == "half" and fold.part in ("top", "bottom") for fold in garment.folds):
        folds.append(Fold("half", "bottom"))
    garment.note("A t-shirt becomes a neat block by folding both sleeves in and the hem up to the shoulders.")
    return folds


def _pants(garment: Garment, goal: str, steps: int | None) -> list[Fold]:
    if goal == "strip":
        return [fold_in_half(garment, "left")]
    if goal not in TIDY:
        raise NotUnderstoodError(f"I know no way to fold pants into a {goal}")
    wanted = steps or (2 if goal == "default" else 3)
    garment.note("Pants become a neat block by laying the legs together and then folding upward.")
    return _repeat(garment, max(1, wanted - len(garment.folds)))


def _quad(garment: Garment, goal: str, steps: int | None) -> list[Fold]:
    if goal in ("triangle", "smalltriangle"):
        return _triangles(garment, goal, steps)
    if goal == "envelope" or (goal == "square" and garment.kind == "square" and steps in (None, 4)):
        garment.note("All four corners to the centre make a smaller square.")
        return [Fold("corner", corner, "centre") for corner in CORNERS]
    if goal == "cupboard":
        return [Fold("middle", "left"), Fold("middle", "right")]
    if goal == "strip":
        return [Fold("half", "long")]
    if goal == "square" and garment.kind != "square" and not garment.folds:
        return [Fold("half", "short")]
    once = goal in ("default", "rectangle")
    return _repeat(garment, steps or (1 if once else 2))


def _triangles(garment: Garment, goal: str, steps: int | None) -> list[Fold]:
    if _triangle(garment) is not None:
        return [fold_in_half(garment)]
    first = Fold("corner", "bottom_left", "top_right")
    garment.note("The instruction leaves open which corner; I take the bottom left one onto the top right one.")
    wanted = steps or (2 if goal == "smalltriangle" else 1)
    if wanted > 2:
        raise NotUnderstoodError("a triangle takes one fold, a smaller triangle two; not more")
    return _repeat(garment, wanted, first=first)
