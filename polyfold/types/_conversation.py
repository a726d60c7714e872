"""Messages to a language model and its replies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from polyfold._brief import brief

Message = Mapping[str, Any]
"""A chat message: ``{"role": "system" | "user" | "assistant", "content": str}``.

With pictures the content is a list of parts: ``{"type": "text", "text": str}`` and ``{"type": "image_url", "image_url":
{"url": "data:image/png;base64,..."}}``.
"""


@dataclass(frozen=True, repr=False)
class Reply:
    """A language model's answer to one request.

    Attributes:
        text: the visible answer.
        reasoning: hidden reasoning, if the provider returned any.
        finish: why it stopped: ``stop``, ``length``, ``refusal``.
        refusal: the reason, when the model refuses; final.
        usage: token counts by name; empty when unknown.
        cost: US dollars; None when unknown, never 0 for unknown.
        cost_source: where the cost comes from: ``provider``, the price table and its date, ``free``; empty: unknown.
        latency_s: duration of the successful call [s].
        attempts: transport tries it took.
        model_served: what answered.
        wall_s: time until the answer was there, failed tries and waits included [s].
        faults: what went wrong in the tries before, and how long was waited, one line each.
        origin: ``live``; ``recorded`` from a cassette; ``recorded nearby`` for a request that differs in numbers only.
    """

    text: str
    reasoning: str | None = None
    finish: str = "stop"
    refusal: str | None = None
    usage: Mapping[str, int] = field(default_factory=dict)
    cost: float | None = None
    latency_s: float = 0.0
    attempts: int = 1
    model_served: str = ""
    cost_source: str = ""
    wall_s: float = 0.0
    faults: Sequence[str] = ()
    origin: str = "live"

    __repr__ = brief


@dataclass(frozen=True, repr=False)
class Call:
    """One request to a language model within an episode, and what came of it.

    Attributes:
        role: what was asked for: ``subgoals``, ``fold_line``, ...
        step: the fold it was asked for, 0 for the first; None before the first.
        attempt: 1 for the first request in this role and step, higher for repairs.
        params: parameters of the request, such as the temperature.
        messages: what was sent; each picture replaced by its SHA-256 and length.
        reply: the answer; None if none came.
        error: why none came.
        rejected: why the answer can't be used; None if it can.
    """

    role: str
    step: int | None
    attempt: int
    params: Mapping[str, Any]
    messages: Sequence[Message]
    reply: Reply | None = None
    error: str | None = None
    rejected: str | None = None

    __repr__ = brief
