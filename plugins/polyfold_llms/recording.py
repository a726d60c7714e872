"""The backends ``record`` and ``replay``: whoever has keys publishes a cassette, others run it again for nothing.

    polyfold evaluate study.toml --out runs/a    # [base.llm]  name = "record:gpt.jsonl"  inner = "litellm:..."
    polyfold evaluate study.toml --out runs/b    # [base.llm]  name = "replay:gpt.jsonl"

Latency, tokens and cost come back as recorded; ``origin`` says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError, LLMAccessError, LLMError
from polyfold.plugins import create
from polyfold.rollout import request_place
from polyfold.types import Message, Reply
from polyfold_llms.cassette import append_line, open_cassette, recorded_models, refuse_secrets
from polyfold_llms.request_keys import model_of, normalized_request, request_key


class RecordLLM:
    """Asks another backend and records what it says; what the cassette has is not asked again."""

    argument: ClassVar[str] = "path"

    class Config(BaseModel):
        """Where to record, and what."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        path: Path = Field(description="cassette, JSON lines; appended to")
        inner: str = Field(default="offline", description="the backend that is recorded, NAME[:ARGUMENT]")
        inner_params: dict[str, Any] = Field(default_factory=dict, description="its parameters")
        sample: int = Field(default=0, ge=0, description="number of the answer, to record several to the same request")

    def __init__(self, config: Config) -> None:
        self._cassette = open_cassette(config.path.resolve())
        self._inner = create("llms", config.inner, config.inner_params)
        self._sample = config.sample
        self.model = model_of(self._inner, config.inner)

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer from the cassette or the backend. Raises LLMError as that does, or if a secret would be kept."""
        request = normalized_request(self.model, messages, params, self._sample)
        known = self._cassette.find(request)
        if known is not None:
            self._cassette.add_place(request, request_place())
            return known
        refuse_secrets(request)
        reply = self._inner.complete(messages, params)
        self._cassette.add(request, request_place(), reply)
        return reply


class ReplayLLM:
    """Answers from a cassette alone, without network or key."""

    argument: ClassVar[str] = "path"

    class Config(BaseModel):
        """Which cassette, and what to do about requests that it lacks."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        path: Path = Field(description="cassette, JSON lines")
        model: str | None = Field(default=None, description="the recorded model; may be left out if there is only one")
        sample: int = Field(
            default=0, ge=0, description="number of the answer, if several to the same request were recorded"
        )
        tolerance: float = Field(
            default=3.0, ge=0, description="answer at the same place if the numbers asked differ by this at most [px]"
        )
        missing: Path | None = Field(default=None, description="file that requests the cassette lacks are added to")

    def __init__(self, config: Config) -> None:
        self._config = config
        if config.missing is None and not config.path.exists():
            raise LLMAccessError(
                f"there is no cassette {config.path}; check the path, or record one: --llm record:PATH"
            )
        self._cassette = open_cassette(config.path.resolve())
        self.model = config.model or self._only_model()

    def _only_model(self) -> str:
        recorded = recorded_models(self._cassette.entries())
        if len(recorded) == 1:
            return recorded[0]
        listed = f"it holds {', '.join(recorded)}" if recorded else "it is empty"
        raise ConfigError(f"say which model of {self._config.path} to replay (--set llm.model=...): {listed}")

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """The recorded answer. Raises LLMError for a request that was not recorded, with the nearest that was."""
        request, place = normalized_request(self.model, messages, params, self._config.sample), request_place()
        found = self._cassette.find(request) or self._cassette.find_nearby(request, place, self._config.tolerance)
        if found is not None:
            return found
        advice = "record it (--llm record:PATH), or collect what is missing (--set llm.missing=requests.jsonl)"
        if self._config.missing is not None:
            full = {**request, "messages": [dict(message) for message in messages]}
            append_line(self._config.missing, {"key": request_key(request), "request": full, "place": dict(place)})
            advice = f"it was added to {self._config.missing}: see polyfold cassette --help"
        raise LLMError(
            f"this request to {self.model!r} is not on the cassette {self._config.path}; "
            f"{self._cassette.describe_nearest(request, place)}; {advice}"
        )
