"""What a request is to a cassette: plain data, its key, a key that numbers do not change, and how two differ."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import Any

from polyfold.rollout import without_pictures
from polyfold.types import Message

REQUEST_VERSION = 1
"""Of the form of requests; part of every key."""

_AROUND = 40
"""Characters shown on either side of the first difference."""

_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")

Request = dict[str, Any]


def normalized_request(model: str, messages: Sequence[Message], params: Mapping[str, Any], sample: int) -> Request:
    """The request as data: what its key is made of. Pictures stand there as SHA-256 and length.

    Args:
        model: what is asked.
        messages: the conversation.
        params: what the prompt and the planner ask for.
        sample: number of this answer among independent ones to the same request.
    """
    return {
        "v": REQUEST_VERSION,
        "model": model,
        "messages": without_pictures(messages),
        "params": dict(params),
        "sample": sample,
    }


def request_key(request: Mapping[str, Any]) -> str:
    """SHA-256 of the request's canonical JSON, in hexadecimal."""
    text = json.dumps(request, sort_keys=True, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def nearby_key(request: Mapping[str, Any], place: Mapping[str, Any]) -> str | None:
    """A key that numbers in the conversation do not change, for the same place in the same episode; None without one.

    Coordinates come out of the simulation, and another processor may move them by a fraction of a pixel. The system's
    message, which holds the prompt, counts as it is.
    """
    if not place:
        return None
    blank = [
        message if message["role"] == "system" else {**message, "content": _NUMBER.sub("#", _text(message))}
        for message in request["messages"]
    ]
    return request_key({**request, "messages": blank, "place": dict(place)})


def largest_difference(a: Mapping[str, Any], b: Mapping[str, Any]) -> float:
    """Largest difference between the corresponding numbers of two requests with the same nearby key."""
    pairs = zip(_numbers(a), _numbers(b), strict=True)
    return max((abs(x - y) for x, y in pairs), default=0.0)


def _numbers(request: Mapping[str, Any]) -> list[float]:
    texts = (_text(message) for message in request["messages"] if message["role"] != "system")
    found = [float(number) for text in texts for number in _NUMBER.findall(text)]
    return [number if math.isfinite(number) else 0.0 for number in found]


def _text(message: Mapping[str, Any]) -> str:
    content = message.get("content")
    return content if isinstance(content, str) else json.dumps(content, sort_keys=True, ensure_ascii=False)


def describe_difference(recorded: Mapping[str, Any], asked: Mapping[str, Any]) -> str:
    """How a request differs from a recorded one, in words: every setting, then the first place in the messages."""
    return "; ".join(_differences(recorded, asked)) or "they do not differ"


def _differences(recorded: Mapping[str, Any], asked: Mapping[str, Any]) -> Iterator[str]:
    for name in ("v", "model", "params", "sample"):
        if recorded[name] != asked[name]:
            yield f"{name}: recorded {recorded[name]!r}, asked {asked[name]!r}"
    pairs = enumerate(zip_longest(recorded["messages"], asked["messages"]), 1)
    for number, (old, new) in pairs:
        if old == new:
            continue
        if old is None or new is None:
            counts = len(recorded["messages"]), len(asked["messages"])
            yield f"recorded are {counts[0]} messages, asked {counts[1]}"
        else:
            yield f"message {number} ({new['role']}) {_first_difference(_text(old), _text(new))}"
        return


def _first_difference(old: str, new: str) -> str:
    at = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    return f"differs at character {at}: recorded {_around(old, at)}, asked {_around(new, at)}"


def _around(text: str, at: int) -> str:
    begin, end = max(0, at - _AROUND), at + _AROUND
    return f"“{'…' * (begin > 0)}{' '.join(text[begin:end].split())}{'…' * (end < len(text))}”"
