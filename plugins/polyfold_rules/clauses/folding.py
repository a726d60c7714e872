"""One clause to folds: what moves, where it goes, and the choice of fold that follows from both."""

from __future__ import annotations

from dataclasses import replace

from polyfold_rules.clauses.clause import MIDDLE, Clause, ahead_of, parts_of
from polyfold_rules.clauses.flaps import fold_band, fold_corner, fold_corners, fold_edge, fold_edges, fold_sleeve
from polyfold_rules.clauses.goals import MAX_HALVES, fold_in_fraction, fold_in_half
from polyfold_rules.clauses.whole import fold_whole
from polyfold_rules.frames.frame import WHOLES, Frame
from polyfold_rules.frames.lookahead import singled_out
from polyfold_rules.shapes.folds import OPPOSITE_CORNER, OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError, Part
from polyfold_rules.words.phrases import NounPhrase


def folds_of_frame(frame: Frame, garment: Garment, previous: Frame | None, steps: int | None) -> list[Fold]:
    """The folds that one clause asks for, given what was folded before."""
    if frame.times < 1:
        raise NotUnderstoodError("it asks for no fold at all")
    if frame.times > MAX_HALVES:
        raise NotUnderstoodError(f"{frame.times} times is more often than cloth can be folded")
    if frame.goals and frame.times > 1:
        frame, steps = replace(frame, times=1), frame.times
    frame = _paired(_begun(_inherited(frame, previous)))
    context = next((p for p in frame.moving if p.noun and p.noun not in WHOLES), None) or frame.context
    moving = _moving_parts(_distinct(frame.moving), garment, context)
    excluded = {part for phrase in frame.excluded for part in parts_of(phrase, garment, "moving", context)}
    moving = [part for part in moving if part not in excluded]
    targets = [part for phrase in frame.targets for part in parts_of(phrase, garment, "target", context)]
    axes = [part for phrase in frame.axes for part in parts_of(phrase, _open(garment), "axis", frame.context)]
    if moving and moving[0].what == "corner" and not targets:
        corners = [part for part in axes if part.what == "corner"]
        targets += corners if len(corners) == 1 else []
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
        moving = _led(moving, frame.leads, garment, context)
    _check_one_place(moving, targets)
    folds: list[Fold] = []
    said = frame.verbs or frame.placed or frame.fractions or frame.goals or frame.same or previous
    if moving and not said and {part.what for part in moving} != {"sleeve"}:
        raise NotUnderstoodError(f"it names “{frame.moving[0].text}” but not what to do with it")
    if not moving:
        for _ in range(frame.times):
            ahead = ahead_of(garment, folds)
            folds += fold_whole(clause, ahead, steps)
        return folds
    corners = [p.text for p in frame.restated if p.noun == "corner" and (p.plural or p.number)]
    if corners and moving[0].what == "edge" and clause.toward(*MIDDLE):
        raise NotUnderstoodError(f"it is unclear whether “{frame.moving[0].text}” or “{corners[0]}” is to be folded")
    for _ in range(frame.times):
        folds += _fold_parts(moving, clause, ahead_of(garment, folds))
    _check_restated(frame, folds)
    return folds


def _moving_parts(phrases: list[NounPhrase], garment: Garment, context: NounPhrase | None) -> list[Part]:
    """The parts that move; *the top left corner and the one opposite* are two."""
    found: list[Part] = []
    for phrase in phrases:
        lone = phrase.quantity == "opposite" and not (phrase.sides or phrase.plural or phrase.number == 2)
        if lone and len(found) == 1 and found[0].what == "corner":
            found.append(replace(found[0], which=OPPOSITE_CORNER[found[0].which]))
        else:
            found += parts_of(phrase, garment, "moving", context)
    return found


def _begun(frame: Frame) -> Frame:
    """``begin with the left sleeve: fold it in``: what is begun with is what moves."""
    if frame.from_source and len(frame.moving) == 2 and singled_out(frame.moving[1], frame.moving[0]):
        return replace(frame, moving=frame.moving[1:], leads=frame.moving[0])
    pronouns = all(not p.names_part and not p.garments for p in frame.moving)
    whole = frame.fractions or frame.goals or "cornertocorner" in frame.manners
    if frame.leads is not None and pronouns and frame.placed and not whole:
        return replace(frame, moving=[frame.leads], leads=None)
    return frame


def _paired(frame: Frame) -> Frame:
    """``one sleeve lies on the other``: both are named, neither moves in particular."""
    other = bool(frame.targets) and frame.targets[0].quantity == "other" and not frame.targets[0].sides
    single = [p for p in frame.moving if p.number == 1 and p.noun in ("sleeve", "leg", "edge") and not p.sides]
    if not (other and single):
        return frame
    both = replace(single[0], number=None, quantity="both", plural=True)
    return replace(frame, moving=[both], targets=[], manners=[*frame.manners, "together"])


def _distinct(phrases: list[NounPhrase]) -> list[NounPhrase]:
    """Without a second, barer mention: *starting at the bottom left, fold that corner*, *two corners, X and Y*."""
    sided = [phrase for phrase in phrases if phrase.sides]
    if len(sided) == len(phrases) - 1 and phrases[0].number == sum(len(p.sides) for p in sided) > 1:
        return [replace(phrase, noun=phrase.noun or phrases[0].noun) for phrase in sided]
    shares = ("third", "quarter") if all(phrase.noun == "corner" for phrase in sided) else ()
    return [phrase for phrase in phrases if phrase.noun in shares or not (sided and _repeats(phrase))]


def _repeats(phrase: NounPhrase) -> bool:
    counted = phrase.sides or phrase.quantity or phrase.number or (phrase.plural and phrase.noun != "corner")
    return bool(phrase.noun) and not counted


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
        moving = [p if p.noun not in (None, "edge") else replace(p, noun=None, pronoun="one") for p in moving]
        return replace(
            previous,
            moving=moving,
            same=True,
            excluded=[],
            leads=frame.leads,
            manners=frame.manners or previous.manners,
            context=next((p for p in previous.moving if p.noun), frame.context),
        )
    if frame.again and not frame.moving and frame.targets:
        return replace(frame, moving=previous.moving)
    if frame.too and not (frame.manners or frame.axes):
        frame = replace(frame, manners=list(previous.manners), axes=_sideless(previous.axes))
    if frame.too and not (frame.targets or frame.directions):
        frame = replace(frame, targets=list(previous.targets))
    bare = frame.specific and not (frame.placed or frame.fractions or frame.goals)
    if bare and (frame.elliptical or not frame.verbs):
        targets = [p for p in previous.targets if p.noun in MIDDLE or p.noun == "body" or p.quantity == "opposite"]
        noun = next((p.noun for p in previous.moving if p.noun), None)
        return replace(
            frame,
            moving=[p if p.noun or p.pronoun else replace(p, noun=noun) for p in frame.moving],
            targets=targets,
            manners=list(previous.manners),
            axes=_sideless(previous.axes),
            directions=[d for d in previous.directions if d not in ("left", "right", "up", "down")],
        )
    return frame


def _sideless(phrases: list[NounPhrase]) -> list[NounPhrase]:
    return [replace(phrase, sides=()) for phrase in phrases]


def _led(moving: list[Part], leads: NounPhrase, garment: Garment, context: NounPhrase | None) -> list[Part]:
    """The parts in the order that the clause asks for: *the two left corners, the bottom one first*."""
    if leads.noun in (None, "corner") and leads.sides and all(part.what == "corner" for part in moving):
        ranks = [next((i for i, g in enumerate(leads.sides) if g <= {*part.which.split("_")}), 9) for part in moving]
    else:
        names = [part.which for part in parts_of(leads, garment, "moving", context)]
        ranks = [names.index(part.which) if part.which in names else 9 for part in moving]
    if len(moving) == 4 and sorted(ranks) == [0, 9, 9, 9]:
        return moving[ranks.index(0) :] + moving[: ranks.index(0)]
    return [part for _, part in sorted(zip(ranks, moving, strict=True), key=lambda ranked: ranked[0])]


def _check_restated(frame: Frame, folds: list[Fold]) -> None:
    """What the clause mentions besides must belong to its folds; else it asks for more than was understood."""
    covered = {side for fold in folds for name in (fold.part, fold.target) for side in name.split("_")}
    covered |= {OPPOSITE_EDGE[fold.part] for fold in folds if fold.action == "half"}
    for phrase in frame.restated:
        if phrase.sides and not all(group & covered for group in phrase.sides):
            raise NotUnderstoodError(
                f"it is unclear what is to be done with “{phrase.text}”; say it in its own sentence"
            )


def _check_one_place(moving: list[Part], targets: list[Part]) -> None:
    places = {part for part in targets if part.what in ("corner", "edge") and part.which not in ("opposite", "any")}
    if len(moving) == 1 and moving[0].what == "corner" and len(places) > 1:
        raise NotUnderstoodError("it names more than one place for the same corner; say one fold after the other")


def _fold_parts(moving: list[Part], clause: Clause, garment: Garment) -> list[Fold]:
    kinds = {part.what for part in moving}
    names = [part.which for part in moving]
    if kinds == {"sleeve", "edge"} and len(set(names)) == 1:
        return _fold_parts([part for part in moving if part.what == "edge"], clause, garment)
    fraction = next((f for f in clause.frame.fractions if f != "half"), None)
    if fraction and kinds == {"edge"} and len(names) == 1:
        return fold_in_fraction(garment, fraction, names[0])
    if kinds == {"edge"} and len(names) > 1:
        return fold_edges(names, clause, garment)
    if kinds == {"corner"} and len(names) > 1:
        together = fold_corners(names, clause, garment)
        if together:
            return together
    if kinds == {"sleeve"} and len(names) == 2 and clause.has("together"):
        return [fold_in_half(garment, names[0])]
    folds: list[Fold] = []
    for part in moving:
        ahead = ahead_of(garment, folds)
        fold_part = {"sleeve": fold_sleeve, "corner": fold_corner, "edge": fold_edge, "band": fold_band}.get(part.what)
        if fold_part is None:
            raise NotUnderstoodError(f"“{clause.frame.moving[0].text}” is no part that can be folded over")
        folds.append(fold_part(part, clause, ahead))
    return folds
