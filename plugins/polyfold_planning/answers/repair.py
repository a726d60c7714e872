"""The repair loop: an invalid answer goes back with the reason, a few times at most."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from polyfold.errors import PlanError, RefusedError
from polyfold.plugins.interfaces import Conversation
from polyfold.prompts import Prompt
from polyfold.types import Reply

Answer = TypeVar("Answer")


def ask_until_valid(
    prompt: Prompt,
    values: Mapping[str, Any],
    read: Callable[[Reply], Answer],
    conversation: Conversation,
    params: Mapping[str, Any],
    max_attempts: int,
) -> Answer:
    """Ask, read the reply, and send back what is wrong with it until it can be used.

    Args:
        prompt: asks in the role ``prompt.id``.
        values: the prompt's inputs.
        read: turns a reply into an answer or raises PlanError with what is wrong.
        conversation: the language model.
        params: override the prompt's own.
        max_attempts: how many answers to ask for.

    Raises:
        RefusedError: at once, if the model refuses.
        PlanError: if no answer could be used; the message holds the last reason.
    """
    messages = prompt.render(**values)
    attempt = 1
    while True:
        reply = conversation.ask(prompt.id, messages, {**prompt.params, **params})
        try:
            return read(reply)
        except PlanError as reason:
            conversation.reject(str(reason))
            if isinstance(reason, RefusedError):
                raise
            if attempt >= max_attempts:
                raise PlanError(
                    f"no usable answer to {prompt.name} after {max_attempts} attempts; the last problem: {reason}; "
                    "rephrase the instruction or choose another language model"
                ) from reason
            messages = [
                *messages,
                {"role": "assistant", "content": reply.text},
                {"role": "user", "content": f"That answer can't be used: {reason}. Answer again, in the same format."},
            ]
        attempt += 1
