"""The conversation of an episode with its language model: every message and reply is recorded as it happens."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from contextvars import ContextVar
from dataclasses import replace
from typing import Any

from polyfold.errors import LLMError
from polyfold.plugins.interfaces import LLM
from polyfold.types import Call, Message, Reply

_place: ContextVar[Mapping[str, Any] | None] = ContextVar("request_place", default=None)


def request_place() -> Mapping[str, Any]:
    """Where in its episode the request under way stands; empty outside of one.

    For backends that file requests: task, garment, seed and instruction of the episode, role, step and attempt.
    """
    return _place.get() or {}


def without_pictures(messages: Sequence[Message]) -> list[dict[str, Any]]:
    """The messages with each picture replaced by its SHA-256 and length in bytes, as data for logs and keys."""
    return [{**message, "content": _hashed(message.get("content"))} for message in messages]


def _hashed(content: Any) -> Any:
    if not isinstance(content, (list, tuple)):
        return content
    return [_hashed_part(part) for part in content]


def _hashed_part(part: Mapping[str, Any]) -> dict[str, Any]:
    if part.get("type") != "image_url":
        return dict(part)
    url = part["image_url"]["url"].encode()
    return {"type": "picture", "sha256": hashlib.sha256(url).hexdigest(), "bytes": len(url)}


class Transcript:
    """Passes requests to a language model and keeps what was said (:class:`polyfold.plugins.interfaces.Conversation`).

    Args:
        llm: what answers; None for an episode without a language model.
        labels: what the episode is about, for :func:`request_place`.

    Attributes:
        calls: every request so far, in order.
        step: the fold that is being decided, 0 for the first; None before the first.
    """

    def __init__(self, llm: LLM | None, labels: Mapping[str, Any] | None = None) -> None:
        self._llm = llm
        self._labels = dict(labels or {})
        self.calls: list[Call] = []
        self.step: int | None = None

    def ask(self, role: str, messages: Sequence[Message], params: Mapping[str, Any] | None = None) -> Reply:
        """Ask the model and record the exchange, the error too if there is one."""
        if self._llm is None:
            raise LLMError("this episode has no language model; an agent that asks one must require the instruction")
        params = dict(params or {})
        attempt = 1 + sum(call.role == role and call.step == self.step for call in self.calls)
        call = Call(role, self.step, attempt, params, without_pictures(messages))
        token = _place.set({**self._labels, "role": role, "step": self.step, "attempt": attempt})
        try:
            reply = self._llm.complete(messages, params)
        except Exception as error:
            self.calls.append(replace(call, error=f"{type(error).__name__}: {error}"))
            raise
        finally:
            _place.reset(token)
        self.calls.append(replace(call, reply=reply))
        return reply

    def reject(self, reason: str) -> None:
        """Record that the last reply can't be used, and why; refusals count."""
        self.calls[-1] = replace(self.calls[-1], rejected=reason)
