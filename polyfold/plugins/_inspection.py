"""What can be known of a chosen component without constructing it: its parameters, and what it reads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.config import ComponentSpec
from polyfold.plugins._host import component_class, configured

if TYPE_CHECKING:
    from pydantic import BaseModel


def parameter_names(kind: str, spec: ComponentSpec) -> list[str]:
    """Names of the parameters that a component takes. Raises PluginError if it is not installed."""
    config = getattr(component_class(kind, spec.name.partition(":")[0]), "Config", None)
    return list(config.model_fields) if config is not None else []


def parameters(kind: str, spec: ComponentSpec) -> Mapping[str, Any]:
    """Its parameters with their values, defaults included. Raises ConfigError for an impossible value."""
    config = _config(kind, spec)
    return {} if config is None else {name: getattr(config, name) for name in type(config).model_fields}


def files_of(kind: str, spec: ComponentSpec) -> Sequence[Path]:
    """Files that a component reads besides its source, such as weights."""
    from polyfold.plugins.interfaces import ReadsFiles

    cls = _class(kind, spec)
    return cls.files_read(_config(kind, spec)) if isinstance(cls, ReadsFiles) else ()


def prompts_of(kind: str, spec: ComponentSpec) -> Sequence[str]:
    """Prompts that a component may use, each as ``role@version``."""
    from polyfold.plugins.interfaces import ReadsPrompts

    cls = _class(kind, spec)
    return cls.prompts_read(_config(kind, spec)) if isinstance(cls, ReadsPrompts) else ()


def _class(kind: str, spec: ComponentSpec) -> type | None:
    """Its class; None for task suites, which are files."""
    return None if kind == "tasks" else component_class(kind, spec.name.partition(":")[0])


def _config(kind: str, spec: ComponentSpec) -> BaseModel | None:
    return configured(kind, spec.name, spec.params)[1]
