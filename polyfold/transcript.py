"""The conversation of an episode with its language model: every message and reply is recorded as it happens."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextvars import ContextVar
from dataclasses import asdict
from pathlib import Path
from typing import Any

from polyfold.errors import LLMError
from polyfold.interfaces import LLM, Message, Reply

__all__ = ["Transcript", "request_place", "without_pictures"]

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
    """Passes requests to a language model and keeps what was said (:class:`polyfold.interfaces.Conversation`).

    Args:
        llm: what answers; None for an episode without a language model.
        labels: what the episode is about, for :func:`request_place`.
    """

    def __init__(self, llm: LLM | None, labels: Mapping[str, Any] | None = None) -> None:
        self._llm = llm
        self._labels = dict(labels or {})
        self.entries: list[dict[str, Any]] = []
        self.step: int | None = None

    def ask(self, role: str, messages: Sequence[Message], params: Mapping[str, Any] | None = None) -> Reply:
        """Ask the model and record the exchange, the error too if there is one."""
        if self._llm is None:
            raise LLMError("this episode has no language model; an agent that asks one must require the instruction")
        params = dict(params or {})
        attempt = 1 + sum(entry["role"] == role and entry["step"] == self.step for entry in self.entries)
        entry: dict[str, Any] = {
            "role": role,
            "step": self.step,
            "attempt": attempt,
            "params": params,
            "messages": without_pictures(messages),
        }
        self.entries.append(entry)
        token = _place.set({**self._labels, "role": role, "step": self.step, "attempt": attempt})
        try:
            reply = self._llm.complete(messages, params)
        except Exception as error:
            entry["error"] = f"{type(error).__name__}: {error}"
            raise
        finally:
            _place.reset(token)
        entry["reply"] = asdict(reply)
        return reply

    def reject(self, reason: str) -> None:
        """Record that the last reply can't be used, and why; refusals count."""
        self.entries[-1]["rejected"] = reason

    def accounts(self) -> dict[str, dict[str, Any]]:
        """What each role took: calls, repairs, tries, tokens, seconds, US dollars; None where a call's is unknown.

        Of its ``questions``, those where a call brought no reply aside, ``valid_at_once`` had a first answer that could
        be used, and ``valid`` had one in the end.
        """
        roles = dict.fromkeys(entry["role"] for entry in self.entries)
        return {role: _account([entry for entry in self.entries if entry["role"] == role]) for role in roles}

    def write(self, path: Path) -> None:
        """Write one exchange a line."""
        lines = (json.dumps(entry, ensure_ascii=False) for entry in self.entries)
        path.write_text("".join(line + "\n" for line in lines), "utf-8")


def _account(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    replies = [entry["reply"] for entry in entries if "reply" in entry]
    valid = [question for question in _questions(entries) if "rejected" not in question[-1]]
    return {
        "questions": len(_questions(entries)),
        "valid_at_once": sum(len(question) == 1 for question in valid),
        "valid": len(valid),
        "calls": len(entries),
        "repairs": sum(entry["attempt"] > 1 for entry in entries),
        "errors": len(entries) - len(replies),
        "tries": sum(reply["attempts"] for reply in replies),
        "prompt_tokens": _total(reply["usage"].get("prompt_tokens") for reply in replies),
        "completion_tokens": _total(reply["usage"].get("completion_tokens") for reply in replies),
        "latency_s": _total(reply["latency_s"] for reply in replies),
        "wall_s": _total(reply["wall_s"] for reply in replies),
        "cost": _total(reply["cost"] for reply in replies),
        "cost_sources": sorted({reply["cost_source"] for reply in replies if reply["cost_source"]}),
        "origins": sorted({reply["origin"] for reply in replies}),
    }


def _questions(entries: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """Exchanges about the same step, repairs included; without those in which the model could not be reached."""
    asked: dict[int | None, list[Mapping[str, Any]]] = {}
    for entry in entries:
        asked.setdefault(entry["step"], []).append(entry)
    return [question for question in asked.values() if all("reply" in entry for entry in question)]


def _total(values: Any) -> Any:
    """The sum; None if one of the values is unknown."""
    values = list(values)
    return None if None in values else sum(values)
