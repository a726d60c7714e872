"""Providers of language models: ``litellm`` for any API or local server, ``record`` and ``replay`` for cassettes.

Public names are loaded when first used, so that importing the package stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_HOMES = {
    "LiteLLM": "polyfold_llms.litellm_backend",
    "Model": "polyfold_llms.model_table",
    "RecordLLM": "polyfold_llms.recording",
    "ReplayLLM": "polyfold_llms.recording",
    "models": "polyfold_llms.model_table",
}

__all__ = ["LiteLLM", "Model", "RecordLLM", "ReplayLLM", "models"]

if TYPE_CHECKING:
    from polyfold_llms.litellm_backend import LiteLLM
    from polyfold_llms.model_table import Model, models
    from polyfold_llms.recording import RecordLLM, ReplayLLM


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'polyfold_llms' has no attribute {name!r}")
