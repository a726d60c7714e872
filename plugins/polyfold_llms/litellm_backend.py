"""The backend ``litellm``: any provider, or a local server, through litellm.

    polyfold fold "fold it in half" --llm litellm:openrouter/openai/gpt-4o          # OPENROUTER_API_KEY is set
    polyfold fold "fold it in half" --llm litellm:ollama_chat/llama3.1:8b           # Ollama on this machine
    polyfold fold "fold it in half" --llm litellm:hosted_vllm/NAME --set llm.api_base=http://127.0.0.1:8000/v1
    polyfold fold "fold it in half" --llm litellm:lm_studio/NAME

A key comes from the environment only and goes to its own provider only: with ``api_base`` none is sent unless
``key_env`` names it. What faults lead to stands in :mod:`polyfold_llms.retries`; tries, waits and price are ours,
litellm's own retries, fallbacks and caches stay off.
"""

from __future__ import annotations

import copy
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError, LLMAccessError
from polyfold.types import Message, Reply
from polyfold_llms import model_table
from polyfold_llms.addresses import check_address, proxy_in_the_way
from polyfold_llms.litellm_client import (
    JSON_ANSWER,
    Heard,
    as_prompted,
    carried_format,
    load_litellm,
    said_in,
    with_cache_marks,
    words_instead,
)
from polyfold_llms.redaction import contains_secret, redact, redacted
from polyfold_llms.retries import (
    CallResult,
    RetryPolicy,
    TransportError,
    call_with_retries,
    header_value,
    server_semaphore,
)

_LONGEST_FAULT = 300
_WRAPPING = re.compile(r"^(litellm\.)?[\w. :]*?(\w+Exception - |Error: |Timeout: )(?!.*Exception - )")
_OWN_PARAMS = frozenset(
    {"model", "messages", "api_key", "api_base", "base_url", "timeout", "stream"}
    | {"max_retries", "num_retries", "fallbacks", "caching", "extra_headers", "headers"}
)
_NEEDED = frozenset({"model", "messages", "timeout", "max_retries", "drop_params"})
_COUNTED = ("prompt_tokens", "completion_tokens", "total_tokens")


class LiteLLM:
    """A language model behind an API; ``litellm:ROUTE/MODEL``."""

    argument: ClassVar[str] = "model"

    class Config(BaseModel):
        """Which model, where, and how patiently."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        model: str = Field(description="ROUTE/MODEL, for example openrouter/openai/gpt-4o")
        api_base: str | None = Field(default=None, description="address of the server, if not the provider's own")
        key_env: str | None = Field(
            default=None, description="environment variable with the key, if not the route's own"
        )
        params: dict[str, Any] = Field(
            default_factory=dict, description="parameters over the prompt's; null leaves one of the prompt's out"
        )
        unlisted: bool = Field(default=False, description="use a model that no table lists")
        timeout_s: float = Field(
            default=180.0, gt=0, description="seconds without a byte after which a try is given up"
        )
        tries: int = Field(default=4, ge=1, le=4, description="tries for one call")
        first_wait_s: float = Field(
            default=1.0, ge=0, description="wait before the second try; it doubles, with jitter"
        )
        longest_wait_s: float = Field(default=60.0, ge=0, le=60, description="cap on waits, those asked for included")
        concurrency: int = Field(default=8, ge=1, le=256, description="calls under way at once, per process and server")

    def __init__(self, config: Config) -> None:
        _check_settings(config)
        model_table.check_model_name(config.model, config.api_base, config.unlisted)
        self._config = config
        self._api_base = config.api_base or model_table.default_api_base(config.model)
        if self._api_base:
            check_address(self._api_base, "api_base" if config.api_base else "told by the environment")
        self._key_variable = config.key_env or (None if self._api_base else model_table.key_variable(config.model))
        if self._key_variable or not self._api_base:
            model_table.check_api_key(config.model, self._key_variable)

    @property
    def model(self) -> str:
        """What is asked, for logs and cassettes."""
        return self._config.model

    @staticmethod
    def count_tokens(model: str, messages: Sequence[Message]) -> int:
        """Tokens of a conversation of text by a model's tokenizer, as far as litellm carries it, else OpenAI's."""
        from polyfold_llms.litellm_client import count_tokens

        return count_tokens(model, messages)

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer a conversation.

        Raises:
            LLMAccessError: if a person must act first: key, credit, address, model's name, a model without vision.
            LLMError: if the request was refused, or no try brought an answer.
        """
        load_litellm()  # before the clock starts
        self._check_pictures(messages)
        request = self._request(messages, params)
        config = self._config
        policy = RetryPolicy(config.tries, config.first_wait_s, config.longest_wait_s)
        semaphore = server_semaphore(self._api_base or self.model.partition("/")[0], config.concurrency)
        what = f"the model {self.model!r}" + (f" at {self._api_base}" if self._api_base else "")
        answer = call_with_retries(lambda: self._attempt(request), policy, what, semaphore)
        return self._reply(answer, request.get("response_format") is JSON_ANSWER)

    def _check_pictures(self, messages: Sequence[Message]) -> None:
        if not any(_has_picture(message) for message in messages):
            return
        known = model_table.find_model(self.model)
        sees = known.vision if known else None
        if sees is None and not self._api_base:
            from polyfold_llms.litellm_client import supports_vision

            sees = supports_vision(self.model)
        if sees is False:
            able = ", ".join(model.id for model in model_table.models() if model.vision)
            raise LLMAccessError(
                f"the model {self.model!r} does not take pictures, and this grounding or planner sends one; "
                f"choose a model that does ({able}) or a grounding of text alone, such as polygon"
            )

    def _request(self, messages: Sequence[Message], params: Mapping[str, Any]) -> dict[str, Any]:
        """What litellm is called with, the key aside."""
        asked = {**params, **self._config.params}
        wanted = model_table.accepted_params(self.model, {n: v for n, v in asked.items() if v is not None})
        return {
            **carried_format(self.model, wanted),
            "model": self.model,
            "messages": with_cache_marks(self.model, [_sendable(message) for message in messages]),
            "timeout": self._config.timeout_s,
            "max_retries": 0,
            "drop_params": True,
        }

    def _attempt(self, request: Mapping[str, Any]) -> Any:
        """One try. Raises TransportError."""
        litellm, heard = load_litellm(), Heard()
        try:
            # litellm writes into what it is given.
            response = litellm.completion(**copy.deepcopy(dict(request)), **self._destination(), logger_fn=heard)
        except litellm.ContentPolicyViolationError:
            return None
        except Exception as error:
            remedy = _remedy(error, request, self._api_base)
            response = _said_instead(error, heard.reply) or _fault(error, litellm, remedy)
        # Raised here and not in the handler, so that it does not hold what the provider sent.
        if isinstance(response, TransportError):
            raise response
        _check_answered(response)
        return response

    def _destination(self) -> dict[str, str]:
        """Address and key; the key lives in this dictionary only."""
        found = {"api_base": self._api_base} if self._api_base else {}
        if self._key_variable:
            found["api_key"] = os.environ.get(self._key_variable, "").strip()
        elif self._api_base:
            found["api_key"] = "none"
        return found

    def _reply(self, answer: CallResult[Any], as_schema: bool) -> Reply:
        timing = {
            "latency_s": round(answer.latency_s, 4),
            "wall_s": round(answer.wall_s, 4),
            "attempts": answer.attempts,
            "faults": answer.faults,
        }
        response = answer.result
        if response is None:
            return Reply("", finish="refusal", refusal="the provider's content filter barred the request", **timing)
        choice = response.choices[0]
        usage = _usage(response)
        cost, source = model_table.call_cost(self.model, usage, getattr(response.usage, "cost", None))
        refusal = _refusal(choice)
        said = _said(choice.message)
        reply = {
            "text": as_prompted(said) if as_schema else said,
            "reasoning": getattr(choice.message, "reasoning_content", None),
            "finish": "refusal" if refusal else "length" if choice.finish_reason == "length" else "stop",
            "refusal": refusal,
            "model_served": str(response.model or ""),
        }
        return Reply(**redacted(reply), usage=usage, cost=cost, cost_source=source, **timing)


def _check_settings(config: LiteLLM.Config) -> None:
    """Refuse settings that would leave a key in run directories, or work against the transport."""
    if contains_secret(config.model_dump_json()):
        raise ConfigError(
            "a key stands among the parameters of 'litellm', which are written to disk; take it out, and put it into "
            "the environment (key_env names the variable)"
        )
    if taken := sorted(_OWN_PARAMS & config.params.keys()):
        raise ConfigError(
            f"params of 'litellm' may not set {', '.join(taken)}; use the backend's own parameters (model, api_base, "
            "key_env, timeout_s, tries), and put keys into the environment"
        )


def _has_picture(message: Message) -> bool:
    content = message.get("content")
    return isinstance(content, (list, tuple)) and any(part.get("type") == "image_url" for part in content)


def _sendable(message: Message) -> dict[str, Any]:
    """The message as sent; several providers refuse an empty answer in a conversation."""
    empty = message.get("role") == "assistant" and not message.get("content")
    return {**message, "content": "(no answer)"} if empty else dict(message)


def _said(message: Any) -> str:
    calls = getattr(message, "tool_calls", None) or ()
    arguments = (getattr(call.function, "arguments", "") for call in calls)
    return said_in(message.content, arguments, getattr(message, "reasoning_content", None))


def _remedy(error: Exception, request: Mapping[str, Any], api_base: str | None) -> str:
    """What helps against a fault that this machine's settings or a parameter may be to blame for; empty if neither."""
    said = str(error)
    blamed = (name for name in request if name not in _NEEDED and re.search(rf"(?<!\w){re.escape(name)}(?!\w)", said))
    if getattr(error, "status_code", None) in (400, 422) and (name := next(blamed, None)):
        return f'; to leave it out, add "{name}": null to the params of this backend'
    return proxy_in_the_way(api_base)


def _fault(error: Exception, litellm: Any, remedy: str) -> TransportError:
    """An error of litellm as a fault, in one line, without secrets."""
    # Where no server answered, the status is an invention of litellm.
    invented = isinstance(error, litellm.APIConnectionError) or "Connection error" in str(error)
    status = None if invented else getattr(error, "status_code", None)
    headers = getattr(error, "litellm_response_headers", None)
    # litellm puts its own classes in front and, for some, a traceback behind.
    said = _WRAPPING.sub("", str(error)).partition("Traceback (most recent call last)")[0] or _first_words(error)
    text = " ".join(redact(said).split())
    if len(text) > _LONGEST_FAULT:
        text = text[:_LONGEST_FAULT] + "..."
    named = (f"{status} {text}" if status else text) + remedy
    return TransportError(status if isinstance(status, int) else None, named, header_value(headers, "retry-after"))


def _said_instead(error: Exception, reply: str) -> TransportError | None:
    """A server's words in a 200 reply without an answer; litellm 1.106.2 loses an error that is a text, and details.

    None where it has passed them on.
    """
    said = " ".join(redact(words_instead(reply)).split())[:_LONGEST_FAULT]
    if not said or said in " ".join(redact(f"{error} {_first_words(error)}").split()):
        return None
    return TransportError(None, f"the server answered with no choices, and said: {said}")


def _first_words(error: BaseException) -> str:
    """What the error said that an error arose from; litellm 1.106.2 loses an error object that came with a 200."""
    first = error
    while before := first.__cause__ or first.__context__:
        first = before
    return str(getattr(first, "message", "") or first)


def _check_answered(response: Any) -> None:
    """Raises TransportError for a 200 that holds no choice, or an error in its choice."""
    if not response.choices:
        raise TransportError(None, "the answer has no choices")
    error = _extra(response.choices[0]).get("error")
    if error:
        code = error.get("code") if isinstance(error, Mapping) else None
        said = error.get("message") if isinstance(error, Mapping) else error
        raise TransportError(
            code if isinstance(code, int) else None, f"the provider failed midway: {redact(str(said))[:200]}"
        )


def _extra(part: Any) -> Mapping[str, Any]:
    return getattr(part, "provider_specific_fields", None) or {}


def _refusal(choice: Any) -> str | None:
    if said := getattr(choice.message, "refusal", None) or _extra(choice.message).get("refusal"):
        return str(said)[:500]
    if choice.finish_reason in ("content_filter", "refusal"):
        return "the provider's content filter withheld the answer"
    return None


def _usage(response: Any) -> dict[str, int]:
    usage = getattr(response, "usage", None)
    counts = {name: getattr(usage, name, None) for name in _COUNTED}
    details = getattr(usage, "completion_tokens_details", None)
    counts["reasoning_tokens"] = getattr(details, "reasoning_tokens", None)
    counts["cached_tokens"] = getattr(getattr(usage, "prompt_tokens_details", None), "cached_tokens", None)
    return {name: int(count) for name, count in counts.items() if count is not None}
