"""The language model ``rules``: a parser of fold language and a geometric reasoner; no key, no network.

It reads only the rendered messages that any model would get, and answers in the same format, reasoning included. What
it does not understand it refuses, with the reason.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from polyfold.geometry import FoldLine
from polyfold.types import Message, Reply
from polyfold_rules.messages import Question, read_messages
from polyfold_rules.shapes.folds import say
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel
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
        elif question.pictured and not question.told:
            text = _refusal(
                "the cloth is shown as a picture only, and the rules model can't see; choose a vision model "
                "(--llm litellm:MODEL) or a grounding with words (--grounding polygon)"
            )
        elif not question.told:
            known = ", ".join(question.cloth) or "nothing that I can read"
            text = _refusal(
                f"the description of the cloth lacks vertices and keypoints (it has {known}), so I don't know where "
                "anything lies; choose a grounding that tells it, such as polygon"
            )
        else:
            try:
                text = _ANSWERS[question.role](question)
            except NotUnderstoodError as reason:
                text = _refusal(str(reason))
        spent = round(time.perf_counter() - clock, 4)
        return Reply(text, cost=0.0, cost_source="free", latency_s=spent, wall_s=spent, model_served=MODEL)


def _garment(question: Question) -> Garment:
    told = question.cloth.get("vertices", question.cloth.get("keypoints"))
    names = told if isinstance(told, Mapping) else question.cloth.get("flat", ())
    return Garment.from_vertices(str(question.cloth.get("garment", "")), names)


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
    return _answer(reasoning, {"fold_line": _line_content(line)})


def _line_content(line: FoldLine) -> dict[str, dict[str, float]]:
    (x0, y0), (x1, y1) = line.start, line.end
    return {"start": {"x": round(x0, 1), "y": round(y0, 1)}, "end": {"x": round(x1, 1), "y": round(y1, 1)}}


def _picks(question: Question) -> str:
    from polyfold_rules.shapes.motions import motion_for

    line, reasoning = _planned_line(question)
    motion = motion_for(line, _points(question), question.arms)
    content = {
        what: [{"x": round(float(x), 1), "y": round(float(y), 1)} for x, y in points]
        for what, points in (("picks", motion.picks), ("places", motion.places))
    }
    return _answer([*reasoning, motion.reasoning], content)


def _whole_plan(question: Question) -> str:
    """All folds that are left, each with its line on the cloth as it will lie then."""
    from polyfold_rules.shapes.creases import crease_of
    from polyfold_rules.shapes.shape import Shape
    from polyfold_rules.wishes.instruction import plan

    garment = _garment(question)
    meaning = plan(question.sentence, garment)
    model, told, reasoning = _flat_model(question, garment.kind), [], list(meaning.notes)
    size = Shape.from_text(question.cloth).size
    for number, fold in enumerate(meaning.folds):
        crease = crease_of(fold, Shape.from_text(json.loads(model.to_text(size))))
        model = model.fold(crease.line)
        if number >= question.done:
            subgoal = say(fold, garment.kind)
            reasoning.append(f"{subgoal}: {crease.reasoning}")
            told.append({"subgoal": subgoal, "fold_line": _line_content(crease.line)})
    return _answer(reasoning, {"plan": told})


def _flat_model(question: Question, kind: str) -> FoldedModel:
    """The garment as it lay before the first fold."""
    from polyfold.polygon import FoldedModel
    from polyfold_rules.shapes.shape import Shape

    flat = Shape.from_text(question.cloth).flat
    return FoldedModel(np.array(list(flat.values())), tuple(flat), {}, kind=kind)


def _planned_line(question: Question) -> tuple[FoldLine, list[str]]:
    """The line that the subgoal's fold turns about, and how it was found."""
    from polyfold_rules.clauses.meaning import understand
    from polyfold_rules.shapes.creases import crease_of
    from polyfold_rules.shapes.shape import Shape

    meaning = understand(question.sentence, _garment(question))
    if len(meaning.folds) != 1:
        raise NotUnderstoodError(f"a subgoal must be one fold, this asks for {len(meaning.folds)}")
    crease = crease_of(meaning.folds[0], Shape.from_text(question.cloth))
    return crease.line, [*meaning.notes, crease.reasoning]


def _points(question: Question) -> Points:
    """The points that picks are reasoned from."""
    from polyfold_rules.shapes.motions import Points
    from polyfold_rules.shapes.shape import Shape

    shape = Shape.from_text(question.cloth)
    if outlines := question.cloth.get("outlines"):
        return Points.of_polygon(shape.points, outlines, shape.size)
    return Points.of_outline(shape.points, shape.outline(), shape.size)


def _refusal(reason: str) -> str:
    return _answer(["I can't turn this into a fold."], {"refused": reason})


def _answer(reasoning: Sequence[str], content: Mapping[str, Any]) -> str:
    return "\n".join(reasoning) + f"\n\n```json\n{json.dumps(content, ensure_ascii=False)}\n```"


_ANSWERS = {"subgoals": _subgoals, "fold_line": _fold_line, "picks": _picks, "plan": _whole_plan}
