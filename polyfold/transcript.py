"""The conversation of an episode with its language model: every message and reply is recorded as it happens."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from polyfold.errors import LLMError
from polyfold.interfaces import LLM, Message, Reply

__all__ = ["Transcript"]


class Transcript:
    """Passes requests to a language model and keeps what was said (:class:`polyfold.interfaces.Conversation`)."""

    def __init__(self, llm: LLM | None) -> None:
        self._llm = llm
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
            "messages": [dict(message) for message in messages],
        }
        self.entries.append(entry)
        try:
            reply = self._llm.complete(messages, params)
        except Exception as error:
            entry["error"] = f"{type(error).__name__}: {error}"
            raise
        entry["reply"] = asdict(reply)
        return reply

    def write(self, path: Path) -> None:
        """Write one exchange a line."""
        lines = (json.dumps(entry, ensure_ascii=False) for entry in self.entries)
        path.write_text("".join(line + "\n" for line in lines), "utf-8")
