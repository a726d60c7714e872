"""The language model ``rules``: a parser of fold language and a geometric reasoner; no key, no network.

It reads only the rendered messages that any model would get, and answers in the same format, reasoning included. What
it does not understand it refuses, with the reason.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from polyfold.interfaces import Message, Reply
from polyfold_llms.folding.folds import say
from polyfold_llms.folding.messages import Question, read_messages
from polyfold_llms.folding.parts import Garment, NotUnderstoodError

__all__ = ["RulesLLM"]

MODEL = "rules-1"


class RulesLLM:
    """Deterministic answers to the roles ``subgoals`` and ``fold_line``."""

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer a conversation; ``params`` (temperature and the like) have nothing to act on."""
        question = read_messages(messages)
        if question is None or not question.role:
            text = _refusal("these messages ask for neither subgoals nor a fold line, which is all that I can answer")
        else:
            try:
                text = {"subgoals": _subgoals, "fold_line": _fold_line}[question.role](question)
            except NotUnderstoodError as reason:
                text = _refusal(str(reason))
        return Reply(text, cost=0.0, cost_source="free", model_served=MODEL)


def _garment(question: Question) -> Garment:
    return Garment.from_vertices(str(question.cloth.get("garment", "")), question.cloth["vertices"])


def _subgoals(question: Question) -> str:
    from polyfold_llms.folding.instruction import plan

    garment = _garment(question)
    meaning = plan(question.sentence, garment)
    count = len(meaning.folds)
    reasoning = [f"A {garment.spoken} lies flat on the table. The instruction takes {count} fold{'s' * (count > 1)}."]
    reasoning += meaning.notes
    return _answer(reasoning, {"subgoals": [say(fold, garment.kind) for fold in meaning.folds]})


def _fold_line(question: Question) -> str:
    from polyfold_llms.folding.creases import crease_of
    from polyfold_llms.folding.meaning import understand
    from polyfold_llms.folding.shape import Shape

    garment = _garment(question)
    meaning = understand(question.sentence, garment)
    if len(meaning.folds) != 1:
        raise NotUnderstoodError(f"a subgoal must be one fold, this asks for {len(meaning.folds)}")
    crease = crease_of(meaning.folds[0], Shape.from_text(question.cloth))
    (x0, y0), (x1, y1) = crease.line.start, crease.line.end
    line = {"start": {"x": round(x0, 1), "y": round(y0, 1)}, "end": {"x": round(x1, 1), "y": round(y1, 1)}}
    return _answer([*meaning.notes, crease.reasoning], {"fold_line": line})


def _refusal(reason: str) -> str:
    return _answer(["I can't turn this into a fold."], {"refused": reason})


def _answer(reasoning: Sequence[str], content: Mapping[str, Any]) -> str:
    return "\n".join(reasoning) + f"\n\n```json\n{json.dumps(content, ensure_ascii=False)}\n```"
