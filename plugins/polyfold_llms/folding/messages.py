"""Finding role, data and question in the messages that a language model would get."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from polyfold.interfaces import Message

__all__ = ["Question", "read_messages"]


@dataclass(frozen=True)
class Question:
    """What the messages ask.

    Attributes:
        role: ``subgoals``, ``fold_line``, or empty when the wording is not recognised.
        cloth: the decoded template or model.
        sentence: the instruction or subgoal.
    """

    role: str
    cloth: Mapping[str, Any]
    sentence: str


def read_messages(messages: Sequence[Message]) -> Question | None:
    """The question, from the last user message that shows a cloth and quotes a sentence; None if there is none."""
    system = " ".join(_content(message) for message in messages if message.get("role") == "system")
    for message in reversed(messages):
        if message.get("role") != "user":
            continue
        values = _json_values(_content(message))
        cloths = [value for value in values if isinstance(value, dict) and "vertices" in value]
        sentences = [value for value in values if isinstance(value, str)]
        if cloths and sentences:
            return Question(_role(system), cloths[-1], sentences[-1])
    return None


def _role(system: str) -> str:
    """The role by the answer that is asked for: its key stands in the format of the answer."""
    keys = {'"subgoals"': "subgoals", '"fold_line"': "fold_line"}
    found = {role for key, role in keys.items() if key in system}
    return found.pop() if len(found) == 1 else ""


def _content(message: Message) -> str:
    content = message.get("content", "")
    if isinstance(content, str):
        return content
    return "\n".join(str(part.get("text", "")) for part in content or () if isinstance(part, Mapping))


def _json_values(text: str) -> list[Any]:
    """Every JSON object and quoted string that begins a line or follows a label."""
    decoder = json.JSONDecoder()
    values = []
    at = 0
    while at < len(text):
        begin = text[at] == "{" or (text[at] == '"' and text[:at].rstrip(" ").endswith((":", "\n")))
        if begin:
            try:
                value, end = decoder.raw_decode(text, at)
            except ValueError:
                at += 1
                continue
            values.append(value)
            at = end
            continue
        at += 1
    return values
