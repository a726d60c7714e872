"""The one place that imports litellm: lazily, with its remote look-ups, retries and chatter switched off.

What it does otherwise than its own tables say stands here too, with the version in which it was measured.
"""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from polyfold_llms.redaction import redact_logs


@cache
def load_litellm() -> Any:
    """The module litellm. The first call takes 2-4 s.

    Without the two variables it looks up a price map on the network (16 s behind a network that swallows packets) and
    loads ``.env`` from the working directory.
    """
    os.environ.setdefault("LITELLM_LOCAL_MODEL_COST_MAP", "True")
    os.environ.setdefault("LITELLM_MODE", "PRODUCTION")
    import litellm

    litellm.suppress_debug_info = True
    # The first completion of a process compiles and imports more; a mock one takes that out of the first latency.
    litellm.completion(model="openai/gpt-4o", messages=[{"role": "user", "content": "x"}], mock_response="x")
    redact_logs("LiteLLM", "openai", "openai._base_client", "httpx")
    # Its debug output holds whole headers, as bytes.
    logging.getLogger("httpcore").setLevel(logging.WARNING)
    return litellm


def has_provider(route: str) -> bool:
    """Whether litellm has a provider of this name."""
    return route in {str(getattr(provider, "value", provider)) for provider in load_litellm().provider_list}


def lists_model(name: str) -> bool:
    """Whether litellm's own table lists the model."""
    table = load_litellm().model_cost
    return name in table or name.partition("/")[2] in table


def missing_environment(name: str) -> Sequence[str]:
    """Environment variables that litellm says a model needs and that are not set."""
    return list(load_litellm().validate_environment(model=name)["missing_keys"])


def supports_vision(name: str) -> bool | None:
    """Whether litellm's table says that the model takes pictures; None if it does not list it."""
    table = load_litellm().model_cost
    entry = table.get(name) or table.get(name.partition("/")[2])
    return None if entry is None else bool(entry.get("supports_vision"))


def count_tokens(name: str, messages: Sequence[Mapping[str, Any]]) -> int:
    """Tokens of a conversation by the model's tokenizer, as far as litellm carries it (else OpenAI's)."""
    asked = {"model": name.removeprefix("openrouter/"), "messages": [dict(message) for message in messages]}
    return int(load_litellm().token_counter(**asked))


JSON_ANSWER: Mapping[str, Any] = {
    "type": "json_schema",
    "json_schema": {
        "name": "answer",
        "strict": True,
        "schema": {
            "type": "object",
            "properties": {
                "reasoning": {"type": "string", "description": "the reasoning that comes before the JSON object"},
                "answer": {"type": "string", "description": "the final JSON object itself, as text"},
            },
            "required": ["reasoning", "answer"],
            "additionalProperties": False,
        },
    },
}
"""What is asked for where ``json_object`` would be lost: reasoning and object, as a schema that fits every prompt."""


def carried_format(name: str, params: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters with a response format that reaches the model.

    litellm 1.106.2 drops ``json_object`` for models on Anthropic's own route, among them some that it lists as
    supporting it, and carries ``json_schema`` for all of them.
    """
    wanted = params.get("response_format")
    if name.startswith("anthropic/") and isinstance(wanted, Mapping) and wanted.get("type") == "json_object":
        return {**params, "response_format": JSON_ANSWER}
    return dict(params)


def as_prompted(text: str) -> str:
    """An answer in the form of :data:`JSON_ANSWER` as the prompts want it: reasoning, then a fenced object."""
    try:
        content = json.loads(text)
    except ValueError:
        return text
    if not isinstance(content, dict) or set(content) != {"reasoning", "answer"}:
        return text  # cut off, or another model than was asked for; the planner will say what is wrong
    return f"{content['reasoning']}\n\n```json\n{content['answer']}\n```"


def said_in(content: str | None, tool_arguments: Iterable[str], reasoning: str | None) -> str:
    """The answer: what a message holds, or else what its call of a tool does, or its reasoning alone.

    Some servers put whole answers of reasoning models, or of those that were taught tools, there and nowhere else.
    """
    if content and content.strip():
        return content
    for arguments in tool_arguments:
        if arguments:
            return f"```json\n{arguments}\n```"
    return reasoning or content or ""


class Heard:
    """A server's reply as litellm logs it: the first of a call, for what follows is litellm's own account of it."""

    def __init__(self) -> None:
        self.reply = ""

    def __call__(self, details: Mapping[str, Any]) -> None:
        """For litellm to call as its ``logger_fn``."""
        self.reply = self.reply or str(details.get("original_response") or "")


def words_instead(reply: str) -> str:
    """What a server says in a reply without an answer: the text of its error, detail or message; empty if none."""
    try:
        content = json.loads(reply)
    except ValueError:
        return ""
    found = content if isinstance(content, dict) and not (content.get("choices") or content.get("content")) else {}
    told = next((found[name] for name in ("error", "detail", "message") if found.get(name)), "")
    while isinstance(told, (list, dict)) and told:  # FastAPI lists what is wrong, OpenAI has an object
        told = told[0] if isinstance(told, list) else told.get("message") or told.get("msg")
    return told if isinstance(told, str) else ""


def with_cache_marks(name: str, messages: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The messages, marked for Claude up to where they are the same in the next call.

    Other providers find a repeated beginning themselves; Anthropic caches it only up to a mark.
    """
    marked = {0, len(messages) - 2} if "claude" in name else set()
    return [_marked(message) if at in marked else dict(message) for at, message in enumerate(messages)]


def _marked(message: Mapping[str, Any]) -> dict[str, Any]:
    content = message.get("content")
    if not isinstance(content, str) or not content:
        return dict(message)
    part = {"type": "text", "text": content, "cache_control": {"type": "ephemeral"}}
    return {**message, "content": [part]}
