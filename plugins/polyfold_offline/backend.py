"""The backend ``offline``: reads sentences with a small network, and reasons exactly about the cloth.

It reads only the rendered messages that a language model would get, and answers in the same format, reasoning
included. What it is not sure to understand it refuses, with the reason.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from polyfold.geometry import FoldLine
from polyfold.types import Message, Reply
from polyfold_offline.cloth.folds import say
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.messages import Question, read_messages

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel
    from polyfold_offline.cloth.motions import Points
    from polyfold_offline.reading.reader import Reader


MODEL = "offline-6"


class OfflineLLM:
    """Answers about cloth that is described in words: subgoals, fold lines, picks and places, whole plans.

    Pictures are not looked at. A cloth that is shown as a picture only is refused.
    """

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer a conversation; ``params`` (temperature and the like) have nothing to act on."""
        clock = time.perf_counter()
        question = read_messages(messages)
        try:
            text = self._answers[_answerable(question).role](question)
        except NotUnderstoodError as reason:
            text = _answer(["I can't turn this into a fold."], {"refused": str(reason)})
        spent = round(time.perf_counter() - clock, 4)
        return Reply(text, cost=0.0, cost_source="free", latency_s=spent, wall_s=spent, model_served=MODEL)

    @cached_property
    def _answers(self) -> Mapping[str, Any]:
        return {"subgoals": self._subgoals, "fold_line": self._fold_line, "picks": self._picks, "plan": self._plan}

    def _subgoals(self, question: Question) -> str:
        garment = Garment.from_text(question.cloth)
        folding = _reader().folds(question.sentence, garment)
        count = len(folding.folds)
        reasoning = [
            f"A {garment.spoken} lies flat on the table. The instruction takes {count} fold{'s' * (count > 1)}.",
            *folding.notes,
        ]
        return _answer(reasoning, {"subgoals": [say(fold, garment.said_as) for fold in folding.folds]})

    def _fold_line(self, question: Question) -> str:
        line, reasoning = self._planned_line(question)
        return _answer(reasoning, {"fold_line": _line_content(line)})

    def _picks(self, question: Question) -> str:
        from polyfold_offline.cloth.motions import motion_for

        line, reasoning = self._planned_line(question)
        motion = motion_for(line, _points(question), question.arms)
        content = {
            what: [{"x": round(float(x), 1), "y": round(float(y), 1)} for x, y in points]
            for what, points in (("picks", motion.picks), ("places", motion.places))
        }
        return _answer([*reasoning, motion.reasoning], content)

    def _plan(self, question: Question) -> str:
        """All folds that are left, each with its line on the cloth as it will lie then."""
        from polyfold_offline.cloth.creases import crease_of
        from polyfold_offline.cloth.shape import Shape

        garment = Garment.from_text(question.cloth)
        folding = _reader().folds(question.sentence, garment)
        model, told, reasoning = _flat_model(question, garment.kind), [], list(folding.notes)
        shape = Shape.from_text(question.cloth)
        for number, fold in enumerate(folding.folds):
            crease = crease_of(fold, Shape.of_model(model, shape.size, 100 * shape.px_per_cm or None))
            model = model.fold(crease.line)
            if number >= question.done:
                subgoal = say(fold, garment.said_as)
                reasoning.append(f"{subgoal}: {crease.reasoning}")
                told.append({"subgoal": subgoal, "fold_line": _line_content(crease.line)})
        return _answer(reasoning, {"plan": told})

    def _planned_line(self, question: Question) -> tuple[FoldLine, list[str]]:
        """The line that the subgoal's fold turns about, and how it was found."""
        from polyfold_offline.cloth.creases import crease_of
        from polyfold_offline.cloth.shape import Shape

        folding = _reader().folds(question.sentence, Garment.from_text(question.cloth))
        if len(folding.folds) != 1:
            raise NotUnderstoodError(f"a subgoal must be one fold, this asks for {len(folding.folds)}")
        crease = crease_of(folding.folds[0], Shape.from_text(question.cloth))
        return crease.line, [*folding.notes, crease.reasoning]


@cache
def _reader() -> Reader:
    """The reader with the weights that come with it."""
    from polyfold_offline.reading.reader import Reader
    from polyfold_offline.weights import SURE, checked_folder

    return Reader(checked_folder(), SURE)


def _answerable(question: Question | None) -> Question:
    """The question, if it is one that can be answered from what it tells."""
    if question is None or not question.role:
        raise NotUnderstoodError(
            "these messages ask for neither subgoals nor a fold line nor picks and places, "
            "which is all that I can answer"
        )
    if question.pictured and not question.told:
        raise NotUnderstoodError(
            "the cloth is shown as a picture only, and the offline model can't see; choose a vision model "
            "(--llm litellm:MODEL) or a grounding with words (--grounding polygon)"
        )
    if not question.told:
        known = ", ".join(question.cloth) or "nothing that I can read"
        raise NotUnderstoodError(
            f"the description of the cloth lacks vertices and keypoints (it has {known}), so I don't know where "
            "anything lies; choose a grounding that tells it, such as polygon"
        )
    return question


def _flat_model(question: Question, kind: str) -> FoldedModel:
    """The garment as it lay before the first fold."""
    from polyfold.polygon import FoldedModel
    from polyfold_offline.cloth.shape import Shape

    flat = Shape.from_text(question.cloth).flat
    return FoldedModel(np.array(list(flat.values())), tuple(flat), {}, kind=kind)


def _points(question: Question) -> Points:
    """The points that picks are reasoned from."""
    from polyfold_offline.cloth.motions import Points
    from polyfold_offline.cloth.shape import Shape

    shape = Shape.from_text(question.cloth)
    if outlines := question.cloth.get("outlines"):
        return Points.of_polygon(shape.points, outlines, shape.size)
    return Points.of_outline(shape.points, shape.outline(), shape.size)


def _line_content(line: FoldLine) -> dict[str, dict[str, float]]:
    (x0, y0), (x1, y1) = line.start, line.end
    return {"start": {"x": round(x0, 1), "y": round(y0, 1)}, "end": {"x": round(x1, 1), "y": round(y1, 1)}}


def _answer(reasoning: Sequence[str], content: Mapping[str, Any]) -> str:
    return "\n".join(reasoning) + f"\n\n```json\n{json.dumps(content, ensure_ascii=False)}\n```"
