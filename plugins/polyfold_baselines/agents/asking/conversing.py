"""Asking a language model for an answer of a given form, and asking again with what is wrong with it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from polyfold.errors import PlanError, RefusedError
from polyfold.plugins.interfaces import Conversation
from polyfold.prompts import load_prompt
from polyfold.types import Reply

_FENCED = re.compile(r"```[ \t]*(?:json)?\s*(\{.*?\})\s*(?:```|\Z)", re.DOTALL | re.IGNORECASE)


class Answer(BaseModel):
    """An answer's object; ``refused`` is the reason why there is no other."""

    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)

    refused: str | None = None


Form = TypeVar("Form", bound=Answer)
Found = TypeVar("Found")


def ask(
    role: str,
    inputs: Mapping[str, Any],
    form: type[Form],
    read: Callable[[Form], Found],
    conversation: Conversation,
) -> Found:
    """What a prompt's newest version is answered.

    Args:
        role: of the prompt.
        inputs: of the prompt.
        form: that the answer must have.
        read: makes of it what was wanted, or raises PlanError with what is wrong, in words for the model.
        conversation: the language model.

    Raises:
        RefusedError: if the model refuses.
        PlanError: if no answer could be used.
    """
    prompt = load_prompt(role)
    messages = prompt.render(**inputs)
    for left in reversed(range(prompt.max_attempts)):
        reply = conversation.ask(prompt.id, messages, prompt.params)
        try:
            return read(_object(reply, form))
        except PlanError as problem:
            conversation.reject(str(problem))
            if isinstance(problem, RefusedError):
                raise
            if not left:
                raise PlanError(
                    f"no usable answer to {prompt.name} after {prompt.max_attempts} attempts; the last problem: "
                    f"{problem}; choose another language model"
                ) from problem
            messages = [
                *messages,
                {"role": "assistant", "content": reply.text},
                {"role": "user", "content": f"That can't be used: {problem}. Answer again, in the same form."},
            ]
    raise PlanError(f"the prompt {prompt.name} allows no attempt; set max_attempts to 1 or more")


def _object(reply: Reply, form: type[Form]) -> Form:
    """The last JSON object of a reply. Raises RefusedError, or PlanError with what is wrong with it."""
    if reply.refusal or reply.finish == "refusal":
        raise RefusedError(f"the language model refused: {reply.refusal or 'no reason given'}")
    found = _FENCED.findall(reply.text) or [reply.text[reply.text.find("{") :]]
    try:
        refused = Answer.model_validate_json(found[-1]).refused
        if refused:
            raise RefusedError(refused[:500])
        return form.model_validate_json(found[-1])
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the JSON at the end"
        raise PlanError(f"{where}: {first['msg'][:200]}") from error
