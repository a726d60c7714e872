"""Clauses that make sense only together: what one leaves out stands in its neighbour."""

from __future__ import annotations

from dataclasses import replace

from polyfold_rules.frames.frame import Frame
from polyfold_rules.words.phrases import NounPhrase

LINES = ("centre", "midline", "gap")
"""Lines on which an edge may come to lie."""


def completed(frames: list[Frame]) -> list[Frame]:
    """The clauses with what they leave out filled in from the one before or after."""
    frames = _distributed(frames)
    return _announced(_forward(_merged([*map(_as_goal, frames[:1]), *frames[1:]])))


def _as_goal(frame: Frame) -> Frame:
    """*Triangle first*: a shape without a verb is what is to be made."""
    if frame.verbs or frame.fractions or not any(p.noun == "triangle" for p in frame.moving):
        return frame
    rest = [phrase for phrase in frame.moving if phrase.noun != "triangle"]
    return replace(frame, moving=rest, leads=frame.leads if rest else None, goals=[*frame.goals, "triangle"])


def _distributed(frames: list[Frame]) -> list[Frame]:
    """*First the left sleeve, then the right one: each is folded in*: what is said of all, said of each."""
    filled: list[Frame] = []
    for frame in frames:
        if frame.shared and filled and filled[-1].specific and not filled[-1].negated:
            filled[-1], frame = _sharing(filled[-1], frame)
        told = 0
        while told < len(filled) and _only_names(filled[-1 - told]):
            told += 1
        them = frame.moving and all(p.pronoun == "them" and not p.names_part for p in frame.moving)
        if them and told > 1 and frame.placed:
            filled[-told:] = [replace(frame, moving=named.moving) for named in filled[-told:]]
        else:
            filled.append(frame)
    return filled


def _sharing(first: Frame, second: Frame) -> tuple[Frame, Frame]:
    """*The right sleeve in, then the left, both straight*: what is said of both."""
    noun = next((p.noun for p in first.moving if p.noun), None)
    shared = replace(
        first,
        targets=first.targets or second.targets,
        manners=first.manners or second.manners,
        axes=first.axes or [replace(p, sides=()) for p in second.axes],
        directions=first.directions or [d for d in second.directions if d in ("in", "over")],
    )
    return shared, replace(second, moving=[p if p.noun else replace(p, noun=noun) for p in second.moving])


def _only_names(frame: Frame) -> bool:
    said = frame.placed or frame.fractions or frame.goals or frame.same or frame.again or frame.negated
    return frame.specific and not said and set(frame.verbs) <= {"grasp"}


def _merged(frames: list[Frame]) -> list[Frame]:
    """Join *take the hem* and *fold it up*, *crease from here to there* and *fold that corner over*."""
    merged: list[Frame] = []
    for frame in frames:
        joined = _with_previous(merged[-1], frame) if merged else None
        if joined is None:
            merged.append(frame)
        else:
            merged[-1] = joined
    return merged


def _with_previous(previous: Frame, frame: Frame) -> Frame | None:
    """Both clauses as one, or None if each stands on its own."""
    if _laid_down(previous, frame):
        return replace(_joined(previous, frame), directions=previous.directions + frame.directions)
    if _continues(previous, frame):
        return _joined(previous, frame)
    if previous.specific and frame.verbs[:1] == ["crease"] and not frame.specific:
        return replace(previous, axes=previous.axes + frame.axes, targets=previous.targets + frame.targets)
    creased = previous.verbs == ["crease"] and previous.axes and not previous.specific
    if creased or _goes_over(previous, frame):
        return replace(frame, axes=previous.axes + frame.axes)
    return None


def _laid_down(previous: Frame, frame: Frame) -> bool:
    """*Take the hem, bring it up, and lay it on the shoulders*: the last clause tells where the way ends."""
    held = previous.grasped or "grasp" in previous.verbs
    nowhere = all(phrase.garments and not phrase.names_part for phrase in previous.targets)
    named = frame.moving or frame.restated
    pronoun = bool(named) and all(p.pronoun and not p.names_part for p in named)
    ends = any(phrase.names_part for phrase in frame.targets) or any(phrase.noun in LINES for phrase in frame.axes)
    return held and nowhere and pronoun and ends and previous.specific and set(frame.verbs) <= {"move", "meet"}


def _continues(previous: Frame, frame: Frame) -> bool:
    if frame.same:
        return False
    if not frame.moving and any(p.noun == "leg" for p in previous.moving):
        return False
    if previous.verbs != ["grasp"] and _meets_in_middle(previous):
        return False
    pronoun = bool(frame.moving) and all(not p.names_part and not p.garments for p in frame.moving)
    if previous.specific and not (previous.targets or previous.directions or previous.fractions or previous.goals):
        return not frame.specific and (pronoun or not frame.moving) and frame.placed and not frame.fractions
    return False


def _meets_in_middle(frame: Frame) -> bool:
    """*Bring top and bottom together in the middle* says all that it needs to."""
    meets = set(frame.manners) & {"together", "meetmiddle", "cupboard"} or "meet" in frame.verbs
    return bool(meets) and ("meetmiddle" in frame.manners or any(p.noun in ("centre", "midline") for p in frame.axes))


def _goes_over(previous: Frame, frame: Frame) -> bool:
    """*Fold along that diagonal; the lower right half goes on top.*"""
    only_line = bool(previous.axes) and not (previous.specific or previous.fractions or previous.goals)
    return only_line and frame.specific and not frame.targets and frame.directions == ["over"]


def _joined(first: Frame, second: Frame) -> Frame:
    return replace(
        second,
        moving=first.moving,
        verbs=first.verbs + second.verbs,
        leads=first.leads or second.leads,
        excluded=first.excluded + second.excluded,
        axes=first.axes + second.axes,
        manners=first.manners + second.manners,
        grasped=first.grasped or second.grasped,
    )


def _forward(frames: list[Frame]) -> list[Frame]:
    """*First the top edge, then the bottom edge, each to the middle*: the place stands in the last clause."""
    filled = list(frames)
    for index in range(len(frames) - 2, -1, -1):
        frame, following = filled[index], filled[index + 1]
        said = frame.placed or frame.fractions or frame.goals or frame.same or (frame.verbs and following.verbs)
        bare = all(p.noun is None and p.pronoun is None for p in frame.moving)
        if said or not frame.specific or not following.specific or not following.placed:
            continue
        if bare and index and filled[index - 1].specific and filled[index - 1].placed:
            continue  # "then the left": another part of the clause before
        if following.verbs and not bare and any(p.noun == "sleeve" for p in frame.moving):
            continue
        nouns = {p.noun for p in following.moving}
        if all(p.noun is None and p.pronoun == "one" for p in following.moving) and not bare:
            nouns = {p.noun for p in frame.moving}  # "the right sleeve first and then the left one"
        noun = next(iter(nouns))
        meant = frame.context.noun if frame.context is not None and not bare else noun
        if all(p.noun in nouns or (p.noun is None and meant == noun) for p in frame.moving):
            filled[index] = replace(
                frame,
                moving=[p if p.noun else replace(p, noun=noun) for p in frame.moving],
                targets=following.targets,
                manners=following.manners,
                directions=[d for d in following.directions if d in ("in", "over")],
                axes=[replace(p, sides=()) for p in following.axes],
            )
    return filled


def _announced(frames: list[Frame]) -> list[Frame]:
    """*Fold both sleeves in: the left straight, the right at a slant*: the first clause only announces the others."""
    kept: list[Frame] = []
    index = 0
    while index < len(frames):
        frame = frames[index]
        details = []
        while index + 1 + len(details) < len(frames) and _details(frame, frames[index + 1 + len(details)]):
            details.append(frames[index + 1 + len(details)])
        if _spelled_out(frame, frames[index + 1 : index + 3]):
            index += 1
            continue
        sides = {side for detail in details for p in detail.moving for group in p.sides for side in group}
        if {"left", "right"} <= sides or {"top", "bottom"} <= sides:
            noun = frame.moving[-1].noun
            for detail in details:
                moving = [replace(p, noun=noun, pronoun=None) for p in detail.moving]
                kept.append(replace(detail, moving=moving, directions=detail.directions or frame.directions))
            index += 1 + len(details)
        else:
            kept.append(frame)
            index += 1
    return kept


def _spelled_out(frame: Frame, following: list[Frame]) -> bool:
    """*In thirds: the lower third up, the upper third down*: two folds that make up the fraction before them."""
    share = set(frame.fractions) & {"third", "quarter"}
    listed = bool(following) and sum(p.noun in share for p in following[0].moving) > 1 and following[0].placed
    return listed or (
        bool(share) and not frame.specific and len(following) == 2 and all(f.specific and f.placed for f in following)
    )


def _details(header: Frame, frame: Frame) -> bool:
    last = header.moving[-1] if header.moving else None
    several = (
        last is not None and last.noun and not last.sides and (last.plural or last.quantity in ("both", "all", "each"))
    )
    return bool(several) and bool(frame.moving) and all(_refers(last, p) for p in frame.moving) and not frame.targets


def _refers(last: NounPhrase | None, phrase: NounPhrase) -> bool:
    return last is not None and bool(phrase.sides) and phrase.noun in (None, last.noun)
