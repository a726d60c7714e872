"""Clauses that fold the whole garment: in half, corner to corner, into a shape, or simply *fold it*."""

from __future__ import annotations

from polyfold_rules.clauses.clause import Clause, moving_edge, parts_of
from polyfold_rules.clauses.goals import fold_for_goal, fold_in_fraction, fold_in_half
from polyfold_rules.shapes.folds import OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.words.phrases import NounPhrase


def fold_whole(clause: Clause, garment: Garment, steps: int | None) -> list[Fold]:
    """The folds of a clause that names no part; ``steps`` if a number of folds was asked for."""
    frame = clause.frame
    if clause.has("cupboard", "meetmiddle") and garment.family == "quad":
        return fold_for_goal(garment, "cupboard", None)
    if clause.has("envelope"):
        return fold_for_goal(garment, "envelope", None)
    if clause.has("cornertocorner", "diagonal") or any(part.what == "diagonal" for part in clause.axes):
        return [_diagonal(clause, garment)]
    creases = [part.which for part in clause.axes if part.what == "corner"]
    if len(creases) == 2 and creases[1] == OPPOSITE_CORNER[creases[0]]:
        return [_diagonal(clause, garment)]
    fraction = frame.fractions[0] if frame.fractions else None
    goal = next((g for g in frame.goals if g not in ("tidy", "store")), frame.goals[0] if frame.goals else None)
    if fraction and fraction != "half":
        return fold_in_fraction(garment, fraction, moving_edge(clause, garment))
    if clause.axes and not fraction and {part.what for part in clause.axes} <= {"armpit", "armhole", "crotch"}:
        raise NotUnderstoodError("it does not say which part to move")
    if fraction or clause.axes or clause.has("edgetoedge", "together"):
        if goal in ("triangle", "smalltriangle"):
            return fold_for_goal(garment, goal, steps)
        return [fold_in_half(garment, moving_edge(clause, garment))]
    if goal:
        if set(frame.verbs) == {"move"} and goal == "store":
            raise NotUnderstoodError("it asks to carry the cloth somewhere; I only fold")
        return _led_folds(fold_for_goal(garment, goal, steps), clause, garment)
    if goal is None and frame.again and garment.folds:
        if garment.folds[-1].action in ("middle", "sleeve", "band"):
            raise NotUnderstoodError("it is unclear what is to be done again")
        return [fold_in_half(garment, moving_edge(clause, garment))]
    if len(clause.targets) == 1 and clause.targets[0].which in OPPOSITE_EDGE and (frame.directions or garment.folds):
        return [fold_in_half(garment, OPPOSITE_EDGE[clause.targets[0].which])]
    if clause.targets:
        raise NotUnderstoodError("it does not say which part to move there")
    if frame.phrasal and frame.directions == ["up"] and garment.family in ("tshirt", "pants") and not garment.folds:
        return fold_for_goal(garment, "default", steps)
    if set(frame.verbs) == {"turn"} and frame.directions == ["over"]:
        raise NotUnderstoodError("turning the whole garment over is no fold; I only fold parts over onto the cloth")
    if (
        frame.manners
        and set(frame.manners) <= {"straight", "slanted", "halfway"}
        and not (frame.directions or frame.again)
    ):
        raise NotUnderstoodError("it does not say which part to move")
    if frame.directions or frame.manners or frame.again:
        return [fold_in_half(garment, moving_edge(clause, garment))]
    if set(frame.verbs) & {"fold", "tidy", "halve"}:
        return fold_for_goal(garment, "default", steps)
    raise NotUnderstoodError("it does not say what to fold and where to")


def _led_folds(folds: list[Fold], clause: Clause, garment: Garment) -> list[Fold]:
    """The folds of a recipe, with the part that the clause wants first moved to the front of its like."""
    if clause.frame.leads is None:
        return folds
    first = {part.which for part in parts_of(clause.frame.leads, garment, "moving", clause.frame.context)}
    kinds = [fold.action for fold in folds]
    return sorted(folds, key=lambda fold: (kinds.index(fold.action), fold.part not in first))


def _diagonal(clause: Clause, garment: Garment) -> Fold:
    if garment.family != "quad":
        raise NotUnderstoodError(f"I know no way to fold a {garment.spoken} corner to corner")
    creases = [part.which for part in clause.axes if part.what == "corner"]
    if not creases and garment.folds:
        return fold_in_half(garment)
    first = frame_lead(clause, garment)
    if first in OPPOSITE_CORNER:
        return Fold("corner", first, OPPOSITE_CORNER[first])
    if creases and OPPOSITE_CORNER[creases[0]] != creases[-1]:
        raise NotUnderstoodError("a diagonal runs between opposite corners; name those two")
    if creases:
        corner = next(c for c in ("bottom_left", "bottom_right") if c not in creases)
    else:
        corner = "bottom_left"
    garment.note(f"The instruction leaves open which corner moves; I take the {corner.replace('_', ' ')} one.")
    return Fold("corner", corner, OPPOSITE_CORNER[corner])


def frame_lead(clause: Clause, garment: Garment) -> str:
    """The part that the clause says to begin with, or an empty string."""
    if clause.frame.leads is None:
        return ""
    found = parts_of(clause.frame.leads, garment, "moving", NounPhrase(noun="corner"))
    return found[0].which if found else ""
