"""What a language model took: calls, repairs, tokens, seconds and cost, counted from the calls of an episode."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from pydantic import BaseModel, ConfigDict


class _Reply(Protocol):
    """What is counted of a reply, of the live one and of its record alike."""

    @property
    def usage(self) -> Mapping[str, int]: ...
    @property
    def cost(self) -> float | None: ...
    @property
    def cost_source(self) -> str: ...
    @property
    def latency_s(self) -> float: ...
    @property
    def wall_s(self) -> float: ...
    @property
    def attempts(self) -> int: ...
    @property
    def origin(self) -> str: ...


class _Call(Protocol):
    """What is counted of a call, of the live one and of its record alike."""

    @property
    def role(self) -> str: ...
    @property
    def step(self) -> int | None: ...
    @property
    def attempt(self) -> int: ...
    @property
    def reply(self) -> _Reply | None: ...
    @property
    def rejected(self) -> str | None: ...


class Account(BaseModel):
    """What one role took; None where a call's figure is unknown.

    Attributes:
        questions: what was asked for, repairs not counted; without those in which a call brought no reply. None in
            logs from before they were counted.
        valid_at_once: questions whose first answer could be used.
        valid: questions that had a usable answer in the end.
        calls: requests.
        repairs: requests that ask again because an answer could not be used.
        errors: requests that brought no reply.
        tries: transport tries of the replies.
        prompt_tokens, completion_tokens: summed over the replies.
        cached_tokens: how many of the prompts' came from the provider's cache, as far as it says.
        latency_s: of the successful calls [s].
        wall_s: with failed tries and waits [s].
        cost: US dollars.
        cost_sources: where costs come from.
        origins: ``live``, ``recorded``, ``recorded nearby``.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    questions: int | None = None
    valid_at_once: int | None = None
    valid: int | None = None
    calls: int
    repairs: int
    errors: int
    tries: int
    prompt_tokens: int | None
    completion_tokens: int | None
    cached_tokens: int | None = None
    latency_s: float | None
    wall_s: float | None
    cost: float | None
    cost_sources: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()


def accounts(calls: Sequence[_Call]) -> dict[str, Account]:
    """What each role took, in the order in which roles were first asked."""
    roles = dict.fromkeys(call.role for call in calls)
    return {role: _account([call for call in calls if call.role == role]) for role in roles}


def _account(calls: Sequence[_Call]) -> Account:
    replies = [call.reply for call in calls if call.reply is not None]
    questions = _questions(calls)
    valid = [question for question in questions if question[-1].rejected is None]
    return Account(
        questions=len(questions),
        valid_at_once=sum(len(question) == 1 for question in valid),
        valid=len(valid),
        calls=len(calls),
        repairs=sum(call.attempt > 1 for call in calls),
        errors=len(calls) - len(replies),
        tries=sum(reply.attempts for reply in replies),
        prompt_tokens=_tokens(replies, "prompt_tokens"),
        completion_tokens=_tokens(replies, "completion_tokens"),
        cached_tokens=_tokens(replies, "cached_tokens"),
        latency_s=sum(reply.latency_s for reply in replies),
        wall_s=sum(reply.wall_s for reply in replies),
        cost=_sum_of_known(reply.cost for reply in replies),
        cost_sources=tuple(sorted({reply.cost_source for reply in replies if reply.cost_source})),
        origins=tuple(sorted({reply.origin for reply in replies})),
    )


def _questions(calls: Sequence[_Call]) -> list[list[_Call]]:
    """Calls about the same step, repairs included; without those in which the model could not be reached."""
    asked: dict[int | None, list[_Call]] = {}
    for call in calls:
        asked.setdefault(call.step, []).append(call)
    return [question for question in asked.values() if all(call.reply is not None for call in question)]


def _tokens(replies: Sequence[_Reply], name: str) -> int | None:
    total = _sum_of_known(reply.usage.get(name) for reply in replies)
    return None if total is None else int(total)


def _sum_of_known(values: Iterable[float | None]) -> float | None:
    """The sum; None if one of the values is unknown."""
    everything = list(values)
    known = [value for value in everything if value is not None]
    return sum(known) if len(known) == len(everything) else None
