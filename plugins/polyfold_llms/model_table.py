"""What is known about language models: the table ``models.toml``, keys by route, and what a call costs."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from polyfold.errors import LLMAccessError, did_you_mean


@dataclass(frozen=True)
class Price:
    """A list price.

    Attributes:
        input: US dollars per million tokens sent.
        output: US dollars per million tokens answered.
        as_of: the day it was read, ``YYYY-MM-DD``.
        source: where.
    """

    input: float
    output: float
    as_of: str
    source: str


@dataclass(frozen=True)
class Model:
    """One entry of ``models.toml``.

    Attributes:
        id: what follows ``litellm:``, the route first.
        label: short name in tables.
        sets: lists that it belongs to: ``paper``, ``current``.
        vision: whether it takes pictures; None if not known.
        response_format: whether it takes that parameter; None if not known.
        unsupported_params: parameters that it refuses, left out of its requests.
        reasoning_reserve: tokens of hidden reasoning, added to what a prompt asks for.
        retired: the day its vendor ends it, ``YYYY-MM-DD``, where known.
        price: None if not known.
    """

    id: str
    label: str
    sets: tuple[str, ...] = ()
    vision: bool | None = None
    response_format: bool | None = None
    unsupported_params: tuple[str, ...] = ()
    reasoning_reserve: int = 0
    retired: str | None = None
    price: Price | None = None


@cache
def _table() -> dict[str, Any]:
    return tomllib.loads((files("polyfold_llms") / "models.toml").read_text("utf-8"))


@cache
def models(listed_in: str | None = None) -> tuple[Model, ...]:
    """The models of the table, in its order; ``listed_in`` keeps to a set, ``paper`` or ``current``."""
    found = [_model(entry) for entry in _table()["model"]]
    return tuple(model for model in found if listed_in is None or listed_in in model.sets)


def _model(entry: Mapping[str, Any]) -> Model:
    price = entry.get("price")
    lists = {name: tuple(entry.get(name, ())) for name in ("sets", "unsupported_params")}
    values: dict[str, Any] = {**entry, **lists}
    values["price"] = Price(**{**price, "as_of": price["as_of"].isoformat()}) if price else None
    values["retired"] = entry["retired"].isoformat() if "retired" in entry else None
    return Model(**values)


def find_model(name: str) -> Model | None:
    """The table's entry for a name, or None."""
    return next((model for model in models() if model.id == name), None)


def accepted_params(name: str, params: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters that a model takes, with its reserve for hidden reasoning in ``max_tokens``."""
    model = find_model(name)
    if model is None:
        return dict(params)
    accepted = {param: value for param, value in params.items() if param not in model.unsupported_params}
    if "max_tokens" in accepted:
        accepted["max_tokens"] += model.reasoning_reserve
    return accepted


def default_api_base(name: str) -> str | None:
    """Where a local server of this route listens unless told otherwise; None for routes of providers.

    The environment tells otherwise with ``ROUTE_API_BASE``, as litellm has it, or for Ollama with its own
    ``OLLAMA_HOST``.
    """
    route = _route(name)
    usual = _table()["local"].get(route)
    if usual is None:
        return None
    family = "ollama" if route.startswith("ollama") else route
    told = os.environ.get(f"{route.upper()}_API_BASE") or os.environ.get(f"{family.upper()}_API_BASE")
    host = os.environ.get("OLLAMA_HOST") if family == "ollama" else None
    return told or (_address(host, usual) if host else usual)


def _address(host: str, usual: str) -> str:
    """An address of ``OLLAMA_HOST``, which may lack its scheme and port, or mean all interfaces of a server."""
    scheme, _, rest = host.rpartition("://")
    where, colon, port = rest.rstrip("/").partition(":")
    where = "127.0.0.1" if where in ("", "0.0.0.0") else where
    default = "80" if scheme == "http" else "443" if scheme == "https" else usual.rpartition(":")[2]
    return f"{scheme or 'http'}://{where}:{port if colon else default}"


def key_variable(name: str) -> str | None:
    """The environment variable with the key of a model's route; None if the table does not know the route."""
    return _table()["keys"].get(_route(name))


def _route(name: str) -> str:
    return name.partition("/")[0]


def check_model_name(name: str, api_base: str | None, unlisted: bool) -> None:
    """Refuse what looks like a typing error, before anything is folded.

    Raises:
        LLMAccessError: if the name has no route, or no table lists the model and nothing says that it exists anyway.
    """
    hint = did_you_mean(name, (model.id for model in models()), f"for example litellm:{models()[1].id}")
    if "/" not in name.strip("/"):
        raise LLMAccessError(
            f"{name!r} does not name a model: write litellm:ROUTE/MODEL, with the provider as route; {hint}"
        )
    known = _table()["keys"].keys() | _table()["local"].keys()
    if find_model(name) or ((api_base or default_api_base(name)) and _route(name) in known):
        return
    from polyfold_llms.litellm_client import has_provider, lists_model

    if _route(name) not in known and not has_provider(_route(name)):
        raise LLMAccessError(f"there is no route {_route(name)!r} to a provider (in {name!r}); {hint}")
    if api_base is None and not unlisted and not lists_model(name):
        raise LLMAccessError(
            f"no table lists the model {name!r}, which may be a typing error; if it exists, say so: "
            f"--set llm.unlisted=true; {hint}"
        )


def check_api_key(name: str, variable: str | None) -> None:
    """Refuse a provider whose key is not in the environment. Raises LLMAccessError naming the variable to set.

    Args:
        name: the model.
        variable: environment variable with the key; None leaves it to litellm to know what a rare route needs.
    """
    if variable is None:
        from polyfold_llms.litellm_client import missing_environment

        missing: Sequence[str] = missing_environment(name)
    else:
        missing = [] if os.environ.get(variable, "").strip() else [variable]
    if missing:
        raise LLMAccessError(
            f"the model {name!r} needs a key in the environment, and {', '.join(missing)} is not set; "
            f"set it (export {missing[0]}=...), or choose --llm offline, which needs none"
        )
    if variable and not os.environ[variable].strip().isascii():
        raise LLMAccessError(f"the key in {variable} has a letter that no key has; copy it from the provider once more")


def call_cost(name: str, usage: Mapping[str, int], reported: Any) -> tuple[float | None, str]:
    """US dollars and where they come from: the provider's own figure, else the table's price, else (None, "").

    Args:
        name: the model.
        usage: token counts.
        reported: what the provider said the call cost, if anything.
    """
    if _is_amount(reported):
        return float(reported), "provider"
    model = find_model(name)
    if model is None or model.price is None or not {"prompt_tokens", "completion_tokens"} <= usage.keys():
        return None, ""
    price = model.price
    dollars = (usage["prompt_tokens"] * price.input + usage["completion_tokens"] * price.output) / 1e6
    return dollars, f"price table of {price.as_of} ({price.source})"


def _is_amount(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value) and value >= 0
