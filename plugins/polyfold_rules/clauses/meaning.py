"""What an instruction asks for: an ordered list of folds, or the reason why it can't be done."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

from polyfold_rules.clauses.clause import parts_of
from polyfold_rules.clauses.folding import folds_of_frame
from polyfold_rules.clauses.goals import fold_for_goal
from polyfold_rules.frames.assembly import frames_of
from polyfold_rules.frames.ellipsis import completed
from polyfold_rules.frames.frame import Frame, Request
from polyfold_rules.shapes.folds import EDGES, OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.words.chatter import plain_tokens
from polyfold_rules.words.tokens import Sentence, read

MAX_FOLDS = 8
AFTERCARE = {"smooth", "smooth out", "flatten", "straighten", "straighten out", "press flat"}
NAMED = {"tshirt": "a t-shirt", "pants": "pants", "square": "a square cloth", "rectangle": "a rectangular cloth"}


@dataclass(frozen=True)
class Meaning:
    """The folds asked for and what was decided on the way."""

    folds: tuple[Fold, ...]
    notes: tuple[str, ...]


def understand(text: str, garment: Garment) -> Meaning:
    """Turn an instruction for this garment into folds.

    Raises:
        NotUnderstoodError: with the reason.
    """
    sentence = read(text)
    tokens, passed = plain_tokens(sentence.tokens)
    request = frames_of(tokens)
    request.frames = _without_aftercare(request.frames, garment)
    _check_garment(request, garment)
    _check_words(request, sentence)
    for wrong, right in sentence.corrections:
        garment.note(f"I read “{wrong}” as “{right}”.")
    for word in (*passed, *request.passed):
        garment.note(f"I pass over the word “{word}”, which I do not know.")
    _give_context(request.frames)
    barred = _barred(request, garment)
    start = len(garment.folds)
    frames = completed([frame for frame in request.frames if not _only_bars(frame)])
    if not frames:
        raise NotUnderstoodError("it names nothing that should be folded")
    _fold_frames(frames, garment, request.steps)
    folds = _without(garment.folds[start:], barred, garment)
    _check_turns(folds)
    _check_count(folds, request.steps)
    return Meaning(tuple(folds), tuple(garment.notes))


def _without_aftercare(frames: list[Frame], garment: Garment) -> list[Frame]:
    """Without *and smooth it down* at the end, which every fold is followed by anyway."""
    last = frames[-1] if len(frames) > 1 else None
    if last is None or not last.refused or last.specific or last.placed or last.unknown:
        return frames
    if set(last.refused) - AFTERCARE or not any(frame.specific and frame.placed for frame in frames[:-1]):
        return frames
    garment.note(f"I pass over “{last.refused[0]}”: folds are laid flat as they are made.")
    return frames[:-1]


def _check_garment(request: Request, garment: Garment) -> None:
    if request.several:
        raise NotUnderstoodError(f"it speaks of several pieces, but one {garment.spoken} lies on the table")
    for named in request.garments:
        if named == "other":
            raise NotUnderstoodError(f"it asks for something else than the {garment.spoken} on the table")
        fits = {
            "tshirt": garment.family == "tshirt", "pants": garment.family == "pants",
            "cloth": garment.family in ("quad", "other"), "square": garment.kind == "square",
            "rectangle": garment.family == "quad" and garment.kind != "square",
        }.get(named, True)  # fmt: skip
        if not fits:
            raise NotUnderstoodError(
                f"it asks for {NAMED.get(named, 'a plain cloth')}, but a {garment.spoken} lies on the table"
            )


def _check_words(request: Request, sentence: Sentence) -> None:
    if not sentence.tokens or not request.frames:
        raise NotUnderstoodError("it holds no folding instruction that I understand")
    for frame in request.frames:
        if frame.negated and (frame.refused or frame.unknown) and not frame.specific:
            continue
        if frame.refused:
            raise NotUnderstoodError(f"“{frame.refused[0]}” is nothing I can do; I only fold parts over onto the cloth")
        if frame.unknown:
            raise NotUnderstoodError(f"I do not understand “{frame.unknown[0]}”")


def _only_bars(frame: Frame) -> bool:
    """Whether the clause says only what not to fold."""
    says = frame.specific or frame.fractions or frame.goals or frame.targets or frame.manners or frame.directions
    return frame.negated or bool(frame.excluded and not says and not any(p.garments for p in frame.moving))


def _give_context(frames: list[Frame]) -> None:
    """Tell every clause which noun was mentioned last before it, for *the right one* and *the other*."""
    last = None
    for frame in frames:
        frame.context = last
        mentioned = [*frame.moving, *frame.excluded, *frame.axes]
        last = next((phrase for phrase in mentioned if phrase.noun), last)
    for frame in reversed(frames):
        frame.context = frame.context or last
        last = next((phrase for phrase in frame.moving if phrase.noun), last)


def _barred(request: Request, garment: Garment) -> set[tuple[str, str]]:
    """Parts that must stay where they are."""
    barred: set[tuple[str, str]] = set()
    for frame in request.frames:
        phrases = list(frame.excluded)
        if frame.negated:
            if frame.refused or frame.unknown:
                continue
            if not frame.specific:
                raise NotUnderstoodError("it says not to fold; nothing is left to do")
            phrases += frame.moving
        for phrase in phrases:
            if phrase.quantity == "other":  # "leave the others": no clause asks for them
                continue
            context = next((p for p in frame.moving if p.noun), frame.context)
            if phrase.noun is None and context is not None:
                phrase = replace(phrase, noun=context.noun)
            probe = Garment(garment.kind, garment.family, list(garment.folds))
            found = parts_of(phrase, probe, "moving", context)
            if not found:
                raise NotUnderstoodError(f"it is unclear what to leave out: “{phrase.text}”")
            barred |= {(part.what, part.which) for part in found}
    return barred


def _fold_frames(frames: list[Frame], garment: Garment, steps: int | None) -> None:
    explicit = any(_explicit(frame) for frame in frames)
    previous: Frame | None = None
    latest: Frame | None = None
    for number, frame in enumerate(frames):
        if _describes(frame, frames[number + 1 :]):
            continue
        vague = not (_explicit(frame) or frame.goals or frame.fractions)
        if vague and garment.folds and not (frame.same or frame.again):
            continue
        if vague and explicit and (previous is None or not (frame.same or frame.again)):
            continue
        if frame.goals and explicit and not _explicit(frame) and frame.goals[0] in ("tidy", "store"):
            continue
        wanted = steps if not explicit else None
        source = latest if frame.again else previous
        if latest is not None and _specifies(frame, latest, garment):
            garment.folds.pop()
        found = folds_of_frame(frame, garment, source, wanted)
        for fold in found:
            garment.folds.append(fold)
            if len(garment.folds) > MAX_FOLDS + 4:
                raise NotUnderstoodError("that is more folds than a piece of cloth can take")
        latest = frame
        if not (frame.same or frame.elliptical) or previous is None:
            previous = frame
    if steps and _repeatable(frames):
        while latest is not None and 0 < len(garment.folds) < min(steps, MAX_FOLDS):
            garment.folds += folds_of_frame(latest, garment, None, None)
    if not garment.folds:
        for fold in fold_for_goal(garment, "default", steps):
            garment.folds.append(fold)


def _specifies(frame: Frame, latest: Frame, garment: Garment) -> bool:
    """``legs together, right over left``: an aside that says how the fold before it is meant."""
    last = garment.folds[-1] if garment.folds else None
    if not frame.aside or frame.again or last is None or len(frame.moving) != 1:
        return False
    probe = replace(garment, folds=garment.folds[:-1], notes=[])
    try:
        found = folds_of_frame(frame, probe, None, None)
    except NotUnderstoodError:  # then it says nothing about the fold before it
        return False
    if len(found) != 1 or found[0].action != last.action:
        return False
    open_side = last.action == "half" and not any(phrase.sides for phrase in latest.moving)
    across = OPPOSITE_EDGE.get(last.part) if open_side else last.part
    return found[0].part in (last.part, across)


def _repeatable(frames: list[Frame]) -> bool:
    """Whether a stated number of folds can mean one clause done so often: *two diagonal folds*."""
    return len(frames) == 1 and not (frames[0].specific or frames[0].targets or frames[0].goals)


def _describes(frame: Frame, later: list[Frame]) -> bool:
    """Whether the clause only names what the following ones spell out: *like a cupboard: both edges to the middle*."""
    named = set(frame.manners) & {"cupboard", "envelope"} or set(frame.goals) & {"envelope"}
    if frame.announces:
        return sum(f.specific and f.placed for f in later) > 1
    return bool(named) and not frame.specific and any(f.specific for f in later[:1])


def _explicit(frame: Frame) -> bool:
    """Whether the clause says itself what is folded, so that nothing needs to be made up."""
    return bool(frame.specific or frame.fractions or frame.targets or frame.manners or frame.axes or frame.directions)


def _without(folds: list[Fold], barred: set[tuple[str, str]], garment: Garment) -> list[Fold]:
    kept = [fold for fold in folds if not barred & _touched(fold)]
    if len(kept) < len(folds) and not kept:
        raise NotUnderstoodError("what it asks to fold is also what it says to leave; nothing is left to do")
    if len(kept) < len(folds):
        garment.note("Parts that the instruction excludes stay where they are.")
    return kept


def _touched(fold: Fold) -> set[tuple[str, str]]:
    what = {"half": "edge", "middle": "edge"}.get(fold.action, fold.action)
    return {(what, fold.part)}


def _check_turns(folds: list[Fold]) -> None:
    """The same fold again, or a half fold and then its mirror image: most likely one fold told twice."""
    once = [(fold.action, fold.part) for fold in folds if fold.action in ("band", "middle", "sleeve")]
    if len(set(once)) < len(once):
        raise NotUnderstoodError("it seems to ask for the same fold twice; name each fold once")
    for first, second in pairwise(folds):
        halves = first.action == second.action == "half" and first.part in EDGES
        if halves and second.part == OPPOSITE_EDGE[first.part]:
            raise NotUnderstoodError(f"it folds the {first.part} half over and then the {second.part} one; say which")


def _check_count(folds: list[Fold], steps: int | None) -> None:
    if not folds:
        raise NotUnderstoodError("it names no fold that I understand")
    if len(folds) > MAX_FOLDS:
        raise NotUnderstoodError(f"{len(folds)} folds are more than a piece of cloth can take")
    if steps is not None and steps != len(folds):
        raise NotUnderstoodError(f"I see no way to do that in {steps} steps; it takes {len(folds)}")
