"""One clause to folds: what moves, where it goes, and the choice of fold that follows from both."""

from __future__ import annotations

from dataclasses import dataclass, replace

from polyfold_llms.folding.folds import OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_llms.folding.frames import WHOLES, Frame
from polyfold_llms.folding.goals import MAX_HALVES, fold_for_goal, fold_in_fraction, fold_in_half
from polyfold_llms.folding.parts import Garment, NotUnderstoodError, Part, resolve
from polyfold_llms.folding.phrases import NounPhrase

__all__ = ["folds_of_frame", "parts_of"]

TOWARDS = {"up": "bottom", "down": "top", "right": "left", "left": "right"}
"""Direction -> the edge that moves that way."""

MIDDLE = ("centre", "midline", "gap")


@dataclass(frozen=True)
class Clause:
    """A frame with its phrases resolved."""

    frame: Frame
    targets: tuple[Part, ...]
    axes: tuple[Part, ...]

    def has(self, *manners: str) -> bool:
        """Whether one of these manners was said."""
        return any(manner in self.frame.manners for manner in manners)

    def toward(self, *places: str) -> bool:
        """Whether a target is one of these places."""
        return any(part.what in places for part in self.targets)


def parts_of(phrase: NounPhrase, garment: Garment, role: str, context: NounPhrase | None) -> list[Part]:
    """The parts a phrase names, checked against the garment."""
    return resolve(phrase, garment, role, context)


def folds_of_frame(frame: Frame, garment: Garment, previous: Frame | None, steps: int | None) -> list[Fold]:
    """The folds that one clause asks for, given what was folded before."""
    if frame.times < 1:
        raise NotUnderstoodError("it asks for no fold at all")
    if frame.times > MAX_HALVES:
        raise NotUnderstoodError(f"{frame.times} times is more often than cloth can be folded")
    frame = _inherited(frame, previous)
    context = next((p for p in frame.moving if p.noun and p.noun not in WHOLES), None) or frame.context
    moving = [part for phrase in _distinct(frame.moving) for part in parts_of(phrase, garment, "moving", context)]
    excluded = {part for phrase in frame.excluded for part in parts_of(phrase, garment, "moving", context)}
    moving = [part for part in moving if part not in excluded]
    targets = [part for phrase in frame.targets for part in parts_of(phrase, garment, "target", context)]
    axes = [part for phrase in frame.axes for part in parts_of(phrase, _open(garment), "axis", frame.context)]
    if moving and moving[0].what == "corner":
        targets += [part for part in axes if part.what == "centre"]
    clause = Clause(frame, tuple(targets), tuple(axes))
    named_shape = any(phrase.noun == "triangle" for phrase in frame.moving) and not garment.folds
    if named_shape and not (moving and frame.verbs) and not frame.fractions:
        frame = replace(frame, goals=["triangle"], moving=[])
        clause = replace(clause, frame=frame)
    moving = [part for part in moving if part.what not in ("result", "rest", "triangle", "body", "crease")]
    if moving and moving[0].what in MIDDLE:
        raise NotUnderstoodError("the middle can't be moved; name an edge, a corner or a part")
    if frame.leads is not None:
        moving = _led(moving, parts_of(frame.leads, garment, "moving", context))
    folds: list[Fold] = []
    said = frame.verbs or frame.placed or frame.fractions or frame.goals or frame.same or previous
    if moving and not said and {part.what for part in moving} != {"sleeve"}:
        raise NotUnderstoodError(f"it names “{frame.moving[0].text}” but not what to do with it")
    if not moving:
        for _ in range(frame.times):
            ahead = replace_folds(garment, folds)
            folds += _fold_whole(clause, ahead, steps)
        return folds
    for _ in range(frame.times):
        folds += _fold_parts(moving, clause, replace_folds(garment, folds))
    return folds


def _distinct(phrases: list[NounPhrase]) -> list[NounPhrase]:
    """Without a second, barer mention: *starting at the bottom left, fold that corner*."""
    sided = [phrase for phrase in phrases if phrase.sides]
    return [
        phrase
        for phrase in phrases
        if phrase.sides or phrase.plural or phrase.quantity or phrase.number or not (phrase.noun and sided)
    ]


def replace_folds(garment: Garment, more: list[Fold]) -> Garment:
    """The garment as it will be after further folds; notes are shared."""
    return replace(garment, folds=[*garment.folds, *more])


def _open(garment: Garment) -> Garment:
    """Notes about free choices make no sense for axes."""
    return replace(garment, notes=[])


def _inherited(frame: Frame, previous: Frame | None) -> Frame:
    """``do the same with the right one``, ``and the right one too``: take over what the clause leaves out."""
    if previous is None:
        return frame
    if frame.same:
        moving = frame.moving or frame.targets
        if not any(phrase.names_part for phrase in moving):
            side = next((d for d in frame.directions if d in ("left", "right")), None)
            moving = [NounPhrase(sides=(frozenset({side}),)) if side else NounPhrase(quantity="other")]
        moving = [p if p.noun else replace(p, pronoun="one") for p in moving]
        return replace(
            previous,
            moving=moving,
            same=True,
            excluded=[],
            leads=frame.leads,
            manners=frame.manners or previous.manners,
        )
    if frame.again and not frame.moving and frame.targets:
        return replace(frame, moving=previous.moving)
    if frame.too and not (frame.manners or frame.axes):
        frame = replace(frame, manners=list(previous.manners), axes=_sideless(previous.axes))
    bare = frame.specific and not (frame.placed or frame.fractions or frame.goals)
    if bare and (frame.elliptical or not frame.verbs):
        targets = [p for p in previous.targets if p.noun in MIDDLE or p.noun == "body" or p.quantity == "opposite"]
        return replace(
            frame, targets=targets, manners=list(previous.manners), axes=_sideless(previous.axes),
            directions=[d for d in previous.directions if d not in ("left", "right", "up", "down")],
        )  # fmt: skip
    return frame


def _sideless(phrases: list[NounPhrase]) -> list[NounPhrase]:
    return [replace(phrase, sides=()) for phrase in phrases]


def _led(moving: list[Part], first: list[Part]) -> list[Part]:
    names = {part.which for part in first}
    return sorted(moving, key=lambda part: part.which not in names)


def _fold_parts(moving: list[Part], clause: Clause, garment: Garment) -> list[Fold]:
    kinds = {part.what for part in moving}
    names = [part.which for part in moving]
    fraction = next((f for f in clause.frame.fractions if f != "half"), None)
    if fraction and kinds == {"edge"} and len(names) == 1:
        return fold_in_fraction(garment, fraction, names[0])
    if kinds == {"edge"} and len(names) > 1:
        return _edge_pair(names, clause, garment)
    if kinds == {"corner"} and len(names) > 1:
        together = _corner_pair(names, clause, garment)
        if together:
            return together
    if kinds == {"sleeve"} and len(names) == 2 and clause.has("together"):
        return [fold_in_half(garment, names[0])]
    folds: list[Fold] = []
    for part in moving:
        ahead = replace_folds(garment, folds)
        fold_part = {"sleeve": _sleeve, "corner": _corner, "edge": _edge, "band": _band}.get(part.what)
        if fold_part is None:
            raise NotUnderstoodError(f"“{clause.frame.moving[0].text}” is no part that can be folded over")
        folds.append(fold_part(part, clause, ahead))
    return folds


# The whole garment ---------------------------------------------------------------------------------------------------


def _fold_whole(clause: Clause, garment: Garment, steps: int | None) -> list[Fold]:
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
        return fold_in_fraction(garment, fraction, _moving_edge(clause, garment))
    if clause.axes and {part.what for part in clause.axes} <= {"armpit", "armhole", "crotch"}:
        raise NotUnderstoodError("it does not say which part to move")
    if fraction or clause.axes or clause.has("edgetoedge", "together"):
        if goal in ("triangle", "smalltriangle"):
            return fold_for_goal(garment, goal, steps)
        return [fold_in_half(garment, _moving_edge(clause, garment))]
    if goal:
        if set(frame.verbs) == {"move"} and goal == "store":
            raise NotUnderstoodError("it asks to carry the cloth somewhere; I only fold")
        return _led_folds(fold_for_goal(garment, goal, steps), clause, garment)
    if clause.targets:
        raise NotUnderstoodError("it does not say which part to move there")
    if set(frame.verbs) == {"turn"} and frame.directions == ["over"]:
        raise NotUnderstoodError("turning the whole garment over is no fold; I only fold parts over onto the cloth")
    if frame.directions or frame.manners or frame.again:
        return [fold_in_half(garment, _moving_edge(clause, garment))]
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


def _moving_edge(clause: Clause, garment: Garment) -> str | None:
    """Which edge moves in a half fold of the whole garment, if the words tell."""
    for direction in clause.frame.directions:
        if direction in TOWARDS:
            return TOWARDS[direction]
    spans = {part.which for part in clause.axes if part.what == "edge"}
    if clause.has("vertical") or spans == {"top", "bottom"}:
        return "left"
    if clause.has("horizontal") or spans == {"left", "right"}:
        return "bottom"
    long_way = garment.kind == "rectangle"
    if clause.has("lengthwise"):
        return "long" if long_way else "left"
    if clause.has("crosswise"):
        return "short" if long_way else "bottom"
    return None


def _diagonal(clause: Clause, garment: Garment) -> Fold:
    if garment.family != "quad":
        raise NotUnderstoodError(f"I know no way to fold a {garment.spoken} corner to corner")
    creases = [part.which for part in clause.axes if part.what == "corner"]
    if not creases and garment.folds:
        return fold_in_half(garment)
    first = frame_lead(clause, garment)
    if first in OPPOSITE_CORNER:
        return Fold("corner", first, OPPOSITE_CORNER[first])
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


# Edges ---------------------------------------------------------------------------------------------------------------


def _edge_pair(names: list[str], clause: Clause, garment: Garment) -> list[Fold]:
    frame = clause.frame
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
            return [fold_in_half(garment, names[0])]
        if (
            len(names) == 2
            and names[1] == OPPOSITE_EDGE.get(names[0])
            and clause.targets == (Part("edge", "opposite"),)
        ):
            return [fold_in_half(garment, names[0])]
        if clause.targets:
            raise NotUnderstoodError("two edges can't both go there; name the middle, or one edge at a time")
    return [Fold("middle", _definite(name, garment)) for name in names]


def _is_legs(frame: Frame) -> bool:
    return any(phrase.noun == "leg" for phrase in frame.moving)


def _definite(edge: str, garment: Garment) -> str:
    if edge in ("any", "long", "short"):
        garment.note("The instruction leaves open which edge; I take the left one.")
        return "left"
    return edge


def _edge(part: Part, clause: Clause, garment: Garment) -> Fold:
    edge = part.which
    if clause.toward(*MIDDLE) or clause.has("halfway", "meetmiddle"):
        return Fold("middle", _definite(edge, garment))
    if _meets_last(edge, clause, garment):
        return Fold("middle", edge)
    goals = [target.which for target in clause.targets if target.what in ("edge", "sleeve", "band")]
    if edge == "any":
        return fold_in_half(garment, _moving_edge(clause, garment))
    for goal in goals:
        if goal in ("opposite", "any", OPPOSITE_EDGE[edge]):
            return fold_in_half(garment, edge)
        if goal == edge:
            raise NotUnderstoodError(f"the {edge} edge is where it should go already; name another target")
        raise NotUnderstoodError(f"I know no fold that lays the {edge} edge onto the {goal} edge next to it")
    if clause.toward("corner"):
        raise NotUnderstoodError("an edge can't be folded onto a corner; name the opposite edge or the middle")
    _check_direction(edge, clause)
    sideways = garment.family == "tshirt" and edge in ("left", "right")
    if "in" in clause.frame.directions and not clause.frame.fractions and (sideways or garment.family == "quad"):
        return Fold("middle", edge)
    if not (clause.frame.directions or clause.frame.fractions or clause.targets or clause.axes):
        garment.note(f"The instruction does not say where to; I fold the {edge} part onto the opposite one.")
    return fold_in_half(garment, edge)


def _meets_last(edge: str, clause: Clause, garment: Garment) -> bool:
    """``fold the top edge to the middle, then the bottom edge up to meet it``."""
    last = garment.folds[-1] if garment.folds else None
    pronoun = any(phrase.pronoun == "it" for phrase in clause.frame.targets)
    return pronoun and last is not None and last.action == "middle" and last.part == OPPOSITE_EDGE.get(edge)


def _check_direction(edge: str, clause: Clause) -> None:
    wrong = {"bottom": "down", "top": "up", "left": "left", "right": "right"}.get(edge)
    if "out" in clause.frame.directions or (wrong in clause.frame.directions):
        raise NotUnderstoodError(
            f"folding the {edge} part that way would move it off the cloth; name the other direction"
        )


def _band(part: Part, clause: Clause, garment: Garment) -> Fold:
    _check_direction(part.which, clause)
    return Fold("band", part.which, share=part.share)


# Corners -------------------------------------------------------------------------------------------------------------


def _corner_pair(names: list[str], clause: Clause, garment: Garment) -> list[Fold] | None:
    """Two corners that move as one edge, or onto each other."""
    if len(names) != 2:
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


def _corner(part: Part, clause: Clause, garment: Garment) -> Fold:
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


def _sleeve(part: Part, clause: Clause, garment: Garment) -> Fold:
    side = part.which
    other = OPPOSITE_EDGE[side]
    if any(target == Part("sleeve", other) for target in clause.targets):
        return fold_in_half(garment, side)
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
