"""The language model ``rules``: a parser of fold language and a geometric reasoner; no key, no network.

It reads only the rendered messages that any model would get, and answers in the same format, reasoning included. What
it does not understand it refuses, with the reason.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from polyfold.geometry import FoldLine
from polyfold.types import Message, Reply
from polyfold_rules.messages import Question, read_messages
from polyfold_rules.shapes.folds import say
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError

if TYPE_CHECKING:
    from polyfold_rules.shapes.motions import Points


MODEL = "rules-1"


class RulesLLM:
    """Deterministic answers about cloth that is described in words: subgoals, fold lines, picks and places.

    Pictures are not looked at. A cloth that is shown as a picture only is refused.
    """

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer a conversation; ``params`` (temperature and the like) have nothing to act on."""
        clock = time.perf_counter()
        question = read_messages(messages)
        if question is None or not question.role:
            text = _refusal(
                "these messages ask for neither subgoals nor a fold line nor picks and places, which is all that I can "
                "answer"
            )
        elif not question.cloth:
            text = _refusal(
                "the cloth is shown as a picture only, and the rules model can't see; choose a vision model "
                "(--llm litellm:MODEL) or a grounding with words (--grounding polygon)"
            )
        else:
            try:
                text = {"subgoals": _subgoals, "fold_line": _fold_line, "picks": _picks}[question.role](question)
            except NotUnderstoodError as reason:
                text = _refusal(str(reason))
        spent = round(time.perf_counter() - clock, 4)
        return Reply(text, cost=0.0, cost_source="free", latency_s=spent, wall_s=spent, model_served=MODEL)


def _garment(question: Question) -> Garment:
    from polyfold_rules.shapes.outlines import family_of, is_nameless

    kind = str(question.cloth.get("garment", ""))
    if is_nameless(question.cloth):
        return family_of(kind)
    return Garment.from_vertices(kind, question.cloth.get("vertices", question.cloth.get("keypoints", ())))


def _subgoals(question: Question) -> str:
    from polyfold_rules.wishes.instruction import plan

    garment = _garment(question)
    meaning = plan(question.sentence, garment)
    count = len(meaning.folds)
    reasoning = [f"A {garment.spoken} lies flat on the table. The instruction takes {count} fold{'s' * (count > 1)}."]
    reasoning += meaning.notes
    return _answer(reasoning, {"subgoals": [say(fold, garment.kind) for fold in meaning.folds]})


def _fold_line(question: Question) -> str:
    line, reasoning = _planned_line(question)
    (x0, y0), (x1, y1) = line.start, line.end
    content = {"start": {"x": round(x0, 1), "y": round(y0, 1)}, "end": {"x": round(x1, 1), "y": round(y1, 1)}}
    return _answer(reasoning, {"fold_line": content})


def _picks(question: Question) -> str:
    from polyfold_rules.shapes.motions import motion_for

    line, reasoning = _planned_line(question)
    motion = motion_for(line, _points(question), question.arms)
    content = {
        what: [{"x": round(float(x), 1), "y": round(float(y), 1)} for x, y in points]
        for what, points in (("picks", motion.picks), ("places", motion.places))
    }
    return _answer([*reasoning, motion.reasoning], content)


def _planned_line(question: Question) -> tuple[FoldLine, list[str]]:
    """The line that the subgoal's fold turns about, and how it was found."""
    from polyfold_rules.clauses.meaning import understand
    from polyfold_rules.shapes.creases import crease_of
    from polyfold_rules.shapes.nameless import crease_of_outline
    from polyfold_rules.shapes.outlines import Outline, is_nameless
    from polyfold_rules.shapes.shape import Shape

    meaning = understand(question.sentence, _garment(question))
    if len(meaning.folds) != 1:
        raise NotUnderstoodError(f"a subgoal must be one fold, this asks for {len(meaning.folds)}")
    fold = meaning.folds[0]
    if is_nameless(question.cloth):
        crease = crease_of_outline(fold, Outline.from_text(question.cloth))
    else:
        crease = crease_of(fold, Shape.from_text(question.cloth))
    return crease.line, [*meaning.notes, crease.reasoning]


def _points(question: Question) -> Points:
    """The points that picks are reasoned from."""
    from polyfold_rules.shapes.motions import Points
    from polyfold_rules.shapes.outlines import Outline, is_nameless
    from polyfold_rules.shapes.shape import Shape

    if is_nameless(question.cloth):
        outline = Outline.from_text(question.cloth)
        names = (f"point {number}" for number in range(1, len(outline.corners) + 1))
        return Points.of_outline(names, outline.corners, outline.size)
    shape = Shape.from_text(question.cloth)
    if "edges" in question.cloth:
        return Points.of_polygon(shape.points, question.cloth["edges"], shape.size)
    return Points.of_outline(shape.points, shape.outline(), shape.size)


def _refusal(reason: str) -> str:
    return _answer(["I can't turn this into a fold."], {"refused": reason})


def _answer(reasoning: Sequence[str], content: Mapping[str, Any]) -> str:
    return "\n".join(reasoning) + f"\n\n```json\n{json.dumps(content, ensure_ascii=False)}\n```"
