"""Requests that a cassette lacks, as files for other programs and batch services, and their answers read back.

Three forms, one line each, joined by ``custom_id``, which is the request's key:

* ``plain``: ``{"key", "model", "messages", "params"}``; answered by ``{"key", "text"}``, and optionally ``finish``,
  ``refusal``, ``model_served``, ``usage``, ``cost``;
* ``openai``: the input and output of OpenAI's Batch API, which others take too;
* ``anthropic``: the ``requests`` and results of Anthropic's Message Batches.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError
from polyfold.types import Reply
from polyfold_llms.cassette import recorded_lines
from polyfold_llms.litellm_client import said_in
from polyfold_llms.model_table import accepted_params, call_cost, find_model
from polyfold_llms.redaction import redacted
from polyfold_llms.request_keys import normalized_request, request_key

FORMS = ("plain", "openai", "anthropic")


@dataclass(frozen=True)
class PendingRequest:
    """A request to be answered: what its key is made of, the messages with their pictures, its place."""

    key: str
    request: Mapping[str, Any]
    messages: tuple[Mapping[str, Any], ...]
    place: Mapping[str, Any]


def read_pending(path: Path) -> list[PendingRequest]:
    """The requests collected in a file, each once. Raises ConfigError naming the line that is none."""
    found: dict[str, PendingRequest] = {}
    for number, content in _json_lines(path):
        try:
            full = content["request"]
            request = normalized_request(full["model"], full["messages"], full["params"], full["sample"])
            entry = PendingRequest(request_key(request), request, tuple(full["messages"]), content["place"])
        except (KeyError, TypeError, AttributeError) as error:
            raise ConfigError(f"{path}, line {number} is no request ({error!r}); collect them anew") from error
        if entry.key != content["key"]:
            raise ConfigError(f"{path}, line {number} was changed and no longer fits its key; collect it anew")
        found.setdefault(entry.key, entry)
    return list(found.values())


def export_line(pending: PendingRequest, form: str, model: str | None = None) -> dict[str, Any]:
    """A request as one line of a form.

    Args:
        pending: the request.
        form: one of :data:`FORMS`.
        model: what the service calls the model; by default its name without the route.
    """
    request = pending.request
    if form == "plain":
        sent = {"model": model or request["model"], "messages": list(pending.messages), "params": request["params"]}
        return {"key": pending.key, **sent}
    name = model or request["model"].rpartition("/")[2]
    params = accepted_params(request["model"], request["params"])
    if form == "openai":
        known = find_model(request["model"])
        if known is not None and known.reasoning_reserve and "max_tokens" in params:
            params["max_completion_tokens"] = params.pop("max_tokens")
        body = {"model": name, "messages": list(pending.messages), **params}
        return {"custom_id": pending.key, "method": "POST", "url": "/v1/chat/completions", "body": body}
    system = "\n\n".join(str(m["content"]) for m in pending.messages if m["role"] == "system")
    turns = [_anthropic_turn(message) for message in pending.messages if message["role"] != "system"]
    body = {"max_tokens": 4096, **params, "model": name, "system": system, "messages": turns}
    return {"custom_id": pending.key, "params": body}


def _anthropic_turn(message: Mapping[str, Any]) -> dict[str, Any]:
    content = message["content"]
    if isinstance(content, str):
        return dict(message)
    return {**message, "content": [_anthropic_part(part) for part in content]}


def _anthropic_part(part: Mapping[str, Any]) -> dict[str, Any]:
    if part.get("type") != "image_url":
        return dict(part)
    head, _, data = part["image_url"]["url"].partition(",")
    media = head.removeprefix("data:").partition(";")[0]
    return {"type": "image", "source": {"type": "base64", "media_type": media, "data": data}}


def read_answers(path: Path) -> Iterator[tuple[str, Reply | str]]:
    """(key, reply) of each line of an answer file of any form; what failed there comes as its reason instead.

    Raises:
        ConfigError: naming a line that has none of the forms.
    """
    for number, content in _json_lines(path):
        try:
            yield str(content.get("custom_id") or content["key"]), _answer(content)
        except (KeyError, TypeError, AttributeError, IndexError) as error:
            raise ConfigError(
                f"{path}, line {number} is no answer ({error!r}); see polyfold_llms.batch for the forms"
            ) from error


def _answer(content: Mapping[str, Any]) -> Reply | str:
    if "response" in content:
        return _openai_answer(content)
    if "result" in content:
        return _anthropic_answer(content["result"])
    if not isinstance(content["text"], str):
        raise TypeError("text must be a string")
    given = {name: content[name] for name in ("finish", "refusal", "model_served", "usage", "cost") if name in content}
    return Reply(content["text"], **redacted(given), cost_source="answer file" if "cost" in given else "")


def _openai_answer(content: Mapping[str, Any]) -> Reply | str:
    response = content["response"]
    if content.get("error") or response["status_code"] != 200:
        return str(content.get("error") or response.get("body"))[:300]
    body = response["body"]
    if not body["choices"]:
        return "the answer has no choices"
    choice = body["choices"][0]
    refusal = choice["message"].get("refusal")
    if choice["finish_reason"] == "content_filter":
        refusal = refusal or "the provider's content filter withheld the answer"
    usage = body.get("usage") or {}
    message = choice["message"]
    arguments = (call["function"]["arguments"] for call in message.get("tool_calls") or ())
    said = said_in(message.get("content"), arguments, message.get("reasoning_content") or message.get("reasoning"))
    return _reply(said, choice["finish_reason"], refusal, usage, body.get("model"))


def _anthropic_answer(result: Mapping[str, Any]) -> Reply | str:
    if result["type"] != "succeeded":
        return str(result.get("error") or result["type"])[:300]
    message = result["message"]
    text = "".join(part["text"] for part in message["content"] if part["type"] == "text")
    counts = message.get("usage") or {}
    usage = {"prompt_tokens": counts.get("input_tokens"), "completion_tokens": counts.get("output_tokens")}
    finish = {"max_tokens": "length"}.get(message["stop_reason"], "stop")
    refusal = "the model refused" if message["stop_reason"] == "refusal" else None
    return _reply(text, finish, refusal, usage, message.get("model"))


def _reply(text: Any, finish: Any, refusal: Any, usage: Mapping[str, Any], model: Any) -> Reply:
    counts = {name: int(count) for name, count in usage.items() if isinstance(count, int)}
    said = redacted({"text": text or "", "refusal": refusal, "model_served": str(model or "")})
    ended = "refusal" if refusal else "length" if finish == "length" else "stop"
    return Reply(**said, finish=ended, usage=counts)


def with_cost(reply: Reply, model: str) -> Reply:
    """The reply with the cost that the price table gives it, unless it brought one.

    Batch services are often cheaper than the table; the source says what it is.
    """
    if reply.cost is not None:
        return reply
    cost, source = call_cost(model, reply.usage, None)
    return replace(reply, cost=cost, cost_source=source)


def _json_lines(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    if not path.exists():
        raise ConfigError(f"there is no file {path}; check the path")
    for number, (line, _) in enumerate(recorded_lines(path, growing=False), 1):
        try:
            content = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise ConfigError(f"{path}, line {number} is not JSON ({error}); correct it") from error
        if not isinstance(content, dict):
            raise ConfigError(f"{path}, line {number} must be a JSON object; correct it")
        yield number, content
