"""The one place that imports litellm: lazily, with its remote look-ups, retries and chatter switched off."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping, Sequence
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
