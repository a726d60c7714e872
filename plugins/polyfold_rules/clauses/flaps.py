"""Clauses that fold a part over: edges, corners, bands and sleeves."""

from __future__ import annotations

from polyfold_rules.clauses.clause import MIDDLE, TOWARDS, Clause, moving_edge
from polyfold_rules.clauses.goals import fold_in_half
from polyfold_rules.frames.frame import Frame
from polyfold_rules.shapes.folds import OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError, Part

PLACES_BESIDE = ("armpit", "armhole", "crotch", "body")
"""Places that no edge is folded to, neither the opposite edge nor the middle."""


# Edges ---------------------------------------------------------------------------------------------------------------


def fold_edges(names: list[str], clause: Clause, garment: Garment) -> list[Fold]:
    """Several edges at once: onto each other, or all to the middle."""
    frame = clause.frame
    _check_places(clause)
    meets = clause.has("together") or "meet" in frame.verbs
    at_middle = meets and any(part.what in MIDDLE for part in clause.axes)
    to_middle = at_middle or clause.toward(*MIDDLE) or clause.has("meetmiddle", "halfway", "cupboard")
    if not to_middle:
        if garment.family == "pants" and set(names) == {"left", "right"}:
            upward = "up" in frame.directions and not meets
            if any(part == Part("edge", "top") for part in clause.targets) or upward:
                return [fold_in_half(garment, "bottom")]
        if (
            clause.has("together", "vertical", "edgetoedge")
            or "meet" in frame.verbs
            or frame.fractions
            or _is_legs(frame)
        ):
            sided = any(phrase.sides for phrase in frame.moving) or _is_legs(frame)
            return [fold_in_half(garment, names[0] if sided else None)]
        if (
            len(names) == 2
            and names[1] == OPPOSITE_EDGE.get(names[0])
            and clause.targets == (Part("edge", "opposite"),)
        ):
            return [fold_in_half(garment, names[0])]
        if clause.targets:
            raise NotUnderstoodError("two edges can't both go there; name the middle, or one edge at a time")
    return [Fold("middle", _definite(name, garment)) for name in names]


def _check_places(clause: Clause) -> None:
    unknown = [phrase for phrase in clause.frame.targets if phrase.noun in PLACES_BESIDE]
    if unknown:
        raise NotUnderstoodError(
            f"I know no fold that ends at “{unknown[0].text}”; name the opposite edge or the middle line"
        )


def _is_legs(frame: Frame) -> bool:
    return any(phrase.noun == "leg" for phrase in frame.moving)


def _definite(edge: str, garment: Garment) -> str:
    if edge in ("long", "short"):
        raise NotUnderstoodError(f"I can't tell which edges are the {edge} ones; say left and right, or top and bottom")
    if edge == "any":
        garment.note("The instruction leaves open which edge; I take the left one.")
        return "left"
    return edge


def fold_edge(part: Part, clause: Clause, garment: Garment) -> Fold:
    """One edge: onto the opposite edge or to the middle line."""
    edge = part.which
    _check_places(clause)
    opposite = any(target == Part("edge", OPPOSITE_EDGE.get(edge, "")) for target in clause.targets)
    if not opposite and not clause.targets:
        opposite = edge in OPPOSITE_EDGE and Part("edge", OPPOSITE_EDGE[edge]) in clause.axes
        if opposite:
            return fold_in_half(garment, edge)
    last = garment.folds[-1] if garment.folds else None
    if opposite and clause.toward(*MIDDLE) and last == Fold("middle", OPPOSITE_EDGE[edge]):
        return Fold("middle", edge)  # the opposite edge lies at the middle by now
    if opposite:
        return fold_in_half(garment, edge)
    if clause.toward(*MIDDLE) or clause.has("halfway", "meetmiddle"):
        return Fold("middle", _definite(edge, garment))
    if _meets_last(edge, clause, garment):
        return Fold("middle", edge)
    if "meet" in clause.frame.verbs and any(part.what == "centre" for part in clause.axes):
        return Fold("middle", _definite(edge, garment))
    goals = [target.which for target in clause.targets if target.what in ("edge", "sleeve", "band")]
    if edge == "any":
        return fold_in_half(garment, moving_edge(clause, garment))
    for goal in goals:
        if goal in ("opposite", "any", OPPOSITE_EDGE[edge]):
            return fold_in_half(garment, edge)
        if goal == edge:
            raise NotUnderstoodError(f"the {edge} edge is where it should go already; name another target")
        raise NotUnderstoodError(f"I know no fold that lays the {edge} edge onto the {goal} edge next to it")
    landing = {target.which for target in clause.targets if target.what == "corner"}
    if landing and landing == {c for c in OPPOSITE_CORNER if OPPOSITE_EDGE.get(edge, "") in c.split("_")}:
        return fold_in_half(garment, edge)
    if landing:
        raise NotUnderstoodError("an edge can't be folded onto a corner; name the opposite edge or the middle")
    _check_direction(edge, clause)
    sideways = garment.family == "tshirt" and edge in ("left", "right")
    if "in" in clause.frame.directions and not clause.frame.fractions and (sideways or garment.family == "quad"):
        return Fold("middle", edge)
    _check_alone(clause, garment)
    if not (clause.frame.directions or clause.frame.fractions or clause.targets or clause.axes):
        plain = any(phrase.noun in (None, "edge", "half") for phrase in clause.frame.moving)
        if plain and not clause.frame.verbs:
            raise NotUnderstoodError(
                f"it does not say where the {edge} part goes; name the opposite edge or the middle"
            )
        garment.note(f"The instruction does not say where to; I fold the {edge} part onto the opposite one.")
    return fold_in_half(garment, edge)


def _check_alone(clause: Clause, garment: Garment) -> None:
    """Parts that only move along with the whole side must not stand for it: a collar, one leg halved on its own."""
    nouns = {phrase.noun for phrase in clause.frame.moving}
    if "neck" in nouns and not clause.targets:
        raise NotUnderstoodError("a collar can't be folded on its own; name the shoulders and where they go")
    one_leg = any(phrase.noun == "leg" and phrase.sides for phrase in clause.frame.moving)
    if one_leg and clause.frame.fractions and not (clause.targets or clause.frame.directions):
        raise NotUnderstoodError("a straight fold takes both legs along; one leg can't be halved on its own")


def _meets_last(edge: str, clause: Clause, garment: Garment) -> bool:
    """``fold the top edge to the middle, then the bottom edge up to meet it``."""
    last = garment.folds[-1] if garment.folds else None
    pronoun = any(phrase.pronoun == "it" for phrase in clause.frame.targets)
    return pronoun and last is not None and last.action == "middle" and last.part == OPPOSITE_EDGE.get(edge)


def _check_direction(edge: str, clause: Clause) -> None:
    said = clause.frame.directions
    wrong = {"bottom": "down", "top": "up", "left": "left", "right": "right"}.get(edge)
    aside = {"up", "down"} if edge in ("left", "right") else {"left", "right"}
    if aside & set(said) and not clause.targets and "over" not in said and edge in OPPOSITE_EDGE:
        raise NotUnderstoodError(f"I know no fold that takes the {edge} part that way; name where it goes")
    if "out" in said or wrong in said:
        raise NotUnderstoodError(
            f"folding the {edge} part that way would move it off the cloth; name the other direction"
        )


def fold_band(part: Part, clause: Clause, garment: Garment) -> Fold:
    """A third or a quarter along an edge."""
    _check_direction(part.which, clause)
    return Fold("band", part.which, share=part.share)


# Corners -------------------------------------------------------------------------------------------------------------


def fold_corners(names: list[str], clause: Clause, garment: Garment) -> list[Fold] | None:
    """Two corners that move as one edge, or onto each other."""
    if len(names) != 2:
        return None
    if clause.toward(*MIDDLE) or clause.has("meetmiddle"):
        return None
    first, second = names
    if second == OPPOSITE_CORNER[first]:
        if (clause.has("together") or "meet" in clause.frame.verbs) and not clause.toward(*MIDDLE):
            return [Fold("corner", first, second)]
        return None
    shared = (set(first.split("_")) & set(second.split("_"))).pop()
    across = {c for c in OPPOSITE_CORNER if OPPOSITE_EDGE[shared] in c.split("_")}
    landing = {target.which for target in clause.targets if target.what == "corner"}
    onto_edge = any(target == Part("edge", OPPOSITE_EDGE[shared]) for target in clause.targets)
    straight_over = any(TOWARDS.get(direction) == shared for direction in clause.frame.directions)
    opposite = "opposite" in landing or any(target.which == "opposite" for target in clause.targets)
    if (
        landing == across
        or onto_edge
        or (opposite and not clause.has("diagonal"))
        or (straight_over and not clause.targets)
    ):
        return [fold_in_half(garment, shared)]
    return None


def fold_corner(part: Part, clause: Clause, garment: Garment) -> Fold:
    """One corner: to the centre or onto another corner."""
    corner = part.which
    if _in_triangle(garment) and not any(phrase.sides for phrase in clause.frame.moving):
        return fold_in_half(garment)
    for target in clause.targets:
        if target.what in ("centre", "midline"):
            return Fold("corner", corner, "centre")
        if target.what == "corner" and target.which == "opposite":
            return Fold("corner", corner, OPPOSITE_CORNER[corner])
        if target.what == "corner" and target.which != corner:
            return Fold("corner", corner, target.which)
        if target.what == "corner":
            raise NotUnderstoodError("that corner is there already; name another target")
        if target.what in ("edge", "band"):
            raise NotUnderstoodError("a corner onto an edge leaves open where on it; name the centre or another corner")
    creases = [axis.which for axis in clause.axes if axis.what == "corner"]
    if len(creases) == 2 and corner not in creases and OPPOSITE_CORNER[creases[0]] == creases[1]:
        return Fold("corner", corner, OPPOSITE_CORNER[corner])
    diagonal = clause.has("diagonal", "cornertocorner") or any(axis.what == "diagonal" for axis in clause.axes)
    if diagonal or any(goal in ("triangle", "smalltriangle") for goal in clause.frame.goals):
        return Fold("corner", corner, OPPOSITE_CORNER[corner])
    if "in" in clause.frame.directions or clause.has("meetmiddle", "envelope"):
        return Fold("corner", corner, "centre")
    if len(clause.frame.moving) == 1 and clause.frame.moving[0].plural:
        garment.note("The instruction does not say where the corners go; I fold them to the centre.")
        return Fold("corner", corner, "centre")
    raise NotUnderstoodError(
        f"it does not say where the {corner.replace('_', ' ')} corner goes: the centre or another corner"
    )


def _in_triangle(garment: Garment) -> bool:
    return any(fold.action == "corner" and fold.target == OPPOSITE_CORNER[fold.part] for fold in garment.folds)


# Sleeves -------------------------------------------------------------------------------------------------------------


def fold_sleeve(part: Part, clause: Clause, garment: Garment) -> Fold:
    """One sleeve: straight in or slanted."""
    side = part.which
    other = OPPOSITE_EDGE[side]
    if any(target == Part("sleeve", other) for target in clause.targets):
        return fold_in_half(garment, side)
    if clause.frame.fractions or clause.has("halfway"):
        raise NotUnderstoodError("a sleeve can't be folded in half on its own; it can be folded in onto the body")
    if side in clause.frame.directions or "out" in clause.frame.directions:
        raise NotUnderstoodError(f"folding the {side} sleeve that way would move it off the shirt; fold it inward")
    if any(fold.action == "sleeve" and fold.part == side for fold in garment.folds):
        raise NotUnderstoodError(f"the {side} sleeve is folded in already")
    return Fold("sleeve", side, manner=_sleeve_manner(clause, garment))


def _sleeve_manner(clause: Clause, garment: Garment) -> str:
    axes = {part.what for part in clause.axes} | {part.which for part in clause.axes if part.what == "edge"}
    phrases = {phrase.noun for phrase in (*clause.frame.axes, *clause.frame.restated)}
    toward_hem = any(target == Part("edge", "bottom") for target in clause.targets) or "down" in clause.frame.directions
    slanted = clause.has("slanted", "diagonal") or "neck" in phrases or "diagonal" in axes or toward_hem
    straight = clause.has("straight", "horizontal", "armhole", "vertical") or "armhole" in axes
    straight = straight or ("armpit" in axes and "shoulder" in phrases)
    if slanted and straight:
        raise NotUnderstoodError("a sleeve can't be folded straight and slanted at once; say one of them")
    if not slanted and not straight:
        garment.note("The instruction leaves open how the sleeve lies; I fold it straight in, along the armhole.")
    return "slanted" if slanted else "straight"
