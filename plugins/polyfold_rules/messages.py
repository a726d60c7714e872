"""Finding role, data and question in the messages that a language model would get."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from polyfold.types import Message

REJECTION = "That answer can't be used"
"""How a message begins that asks for the last answer once more."""


@dataclass(frozen=True)
class Question:
    """What the messages ask.

    Attributes:
        role: ``subgoals``, ``fold_line``, ``picks``, ``plan``, or empty when the wording is not recognised.
        cloth: the decoded template, model or keypoints; empty when none is told.
        sentence: the instruction or subgoal.
        done: how many folds have been done, as far as they are listed.
        pictured: whether the cloth is shown as a picture.
        arms: how many picks the answer should have, in the role ``picks``.
    """

    role: str
    cloth: Mapping[str, Any]
    sentence: str
    pictured: bool = False
    done: int = 0
    arms: int = 1

    @property
    def told(self) -> bool:
        """Whether the description says where anything of the cloth lies."""
        return bool(self.cloth.keys() & {"vertices", "keypoints"})


def read_messages(messages: Sequence[Message]) -> Question | None:
    """The question, from the last user message that quotes a sentence; None if there is none.

    What comes before it are worked examples, of which no answer is ever made. Pictures are not looked at: where one
    comes with a text about the cloth, the text is all that counts.
    """
    system = " ".join(_content(message) for message in messages if message.get("role") == "system")
    for message in reversed(messages):
        content = _content(message)
        if message.get("role") != "user" or content.startswith(REJECTION):
            continue
        values = _json_values(content)
        cloths = [value for value in values if isinstance(value, dict)]
        sentences = [value for value in values if isinstance(value, str)]
        if not sentences:
            return None
        cloth = cloths[0] if cloths else {}
        done = sum(len(value) for value in values if isinstance(value, list))
        return Question(_role(system), cloth, sentences[-1], _has_picture(message), done, _arms(system))
    return None


def _role(system: str) -> str:
    """The role by the answer that is asked for: its key stands in the format of the answer."""
    keys = {'{"plan"': "plan", '{"subgoals"': "subgoals", '{"fold_line"': "fold_line", '{"picks"': "picks"}
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
    """Every JSON object, and every list and quoted string that begins a line or follows a label."""
    decoder = json.JSONDecoder()
    values = []
    at = 0
    while at < len(text):
        begin = text[at] == "{" or (text[at] in '"[' and text[:at].rstrip(" ").endswith((":", "\n")))
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
