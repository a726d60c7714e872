"""What can be known of a chosen component without constructing it: its parameters, and what it reads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.plugins._fabrics import is_usual, usual_parameters
from polyfold.plugins._host import HOST
from polyfold.plugins._traits import Configurable, ReadsFiles, ReadsPrompts, moved_to

if TYPE_CHECKING:
    from polyfold.config import ComponentSpec


def parameter_names(kind: str, spec: ComponentSpec) -> list[str]:
    """Names of the parameters that a component takes. Raises PluginError if it is not installed."""
    if is_usual(kind, spec):
        return usual_parameters()
    cls = HOST.component_class(kind, spec.name.partition(":")[0])
    return list(cls.Config.model_fields) if isinstance(cls, Configurable) else []


def moved_parameter(kind: str, spec: ComponentSpec, parameter: str) -> str | None:
    """What to do about a parameter that a component no longer has; None if it never had it."""
    return (
        None if is_usual(kind, spec) else moved_to(HOST.component_class(kind, spec.name.partition(":")[0]), parameter)
    )


def parameters(kind: str, spec: ComponentSpec) -> Mapping[str, Any]:
    """Its parameters with their values as plain data, defaults included. Raises ConfigError for an impossible value."""
    config = HOST.configured(kind, spec.name, spec.params)[1]
    return {} if config is None else config.model_dump(mode="json")


def files_read(kind: str, spec: ComponentSpec) -> Sequence[Path]:
    """Files that a component reads besides its source, such as weights."""
    cls, config = HOST.configured(kind, spec.name, spec.params)
    return cls.files_read(config) if isinstance(cls, ReadsFiles) else ()


def prompts_read(kind: str, spec: ComponentSpec) -> Sequence[str]:
    """Prompts that a component may use, each as ``role@version``."""
    cls, config = HOST.configured(kind, spec.name, spec.params)
    return cls.prompts_read(config) if isinstance(cls, ReadsPrompts) else ()
