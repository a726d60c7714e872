"""Finding role, data and question in the messages that a language model would get."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from polyfold.types import Message


@dataclass(frozen=True)
class Question:
    """What the messages ask.

    Attributes:
        role: ``subgoals``, ``fold_line``, ``picks``, or empty when the wording is not recognised.
        cloth: the decoded template, model or keypoints; empty when the cloth is shown as a picture only.
        sentence: the instruction or subgoal.
        arms: how many picks the answer should have, in the role ``picks``.
    """

    role: str
    cloth: Mapping[str, Any]
    sentence: str
    arms: int = 1


def read_messages(messages: Sequence[Message]) -> Question | None:
    """The question, from the last user message that shows a cloth and quotes a sentence; None if there is none.

    Pictures are not looked at: where one comes with a text about the cloth, the text is all that counts.
    """
    system = " ".join(_content(message) for message in messages if message.get("role") == "system")
    for message in reversed(messages):
        if message.get("role") != "user":
            continue
        values = _json_values(_content(message))
        cloths = [value for value in values if isinstance(value, dict) and value.keys() & {"vertices", "keypoints"}]
        sentences = [value for value in values if isinstance(value, str)]
        if sentences and (cloths or _has_picture(message)):
            return Question(_role(system), cloths[-1] if cloths else {}, sentences[-1], _arms(system))
    return None


def _role(system: str) -> str:
    """The role by the answer that is asked for: its key stands in the format of the answer."""
    keys = {'"subgoals"': "subgoals", '"fold_line"': "fold_line", '"picks"': "picks"}
    found = {role for key, role in keys.items() if key in system}
    return found.pop() if len(found) == 1 else ""


def _arms(system: str) -> int:
    """How many picks the format of the answer shows."""
    formats = [value["picks"] for value in _json_values(system) if isinstance(value, dict) and "picks" in value]
    return max((len(picks) for picks in formats if isinstance(picks, list)), default=1)


def _has_picture(message: Message) -> bool:
    content = message.get("content")
    parts = [] if isinstance(content, str) else content or ()
    return any(isinstance(part, Mapping) and part.get("type") == "image_url" for part in parts)


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
