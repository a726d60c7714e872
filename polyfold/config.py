"""One model of an experiment: which components, with which parameters; TOML in and out."""

from __future__ import annotations

import tomllib
from os import PathLike
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from polyfold.errors import ConfigError, validation_problem
from polyfold.errors._hints import file_problem, toml_problem

__all__ = ["ComponentSpec", "Experiment", "read_toml"]

USUAL = "usual"
"""Stands for the fabric that a kind of garment is usually made of; no component is called so."""


class ComponentSpec(BaseModel):
    """A component by name, with parameters. In TOML ``policy = "farthest"`` or a table ``[policy]`` with ``name``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    params: dict[str, Any] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _from_short_form(cls, value: Any) -> Any:
        if isinstance(value, str):
            return {"name": value}
        if not isinstance(value, dict | ComponentSpec):
            raise ValueError(
                f'{value!r} names no component; write a name, for example "farthest", or a table with a name'
            )
        if isinstance(value, dict) and "params" not in value:
            return {"name": value.get("name"), "params": {key: v for key, v in value.items() if key != "name"}}
        return value

    def with_parameter(self, path: str, value: Any) -> ComponentSpec:
        """A copy with one parameter set, or one in tables among them.

        Args:
            path: its name, or those of the tables and its own with dots between: ``arms.robot``.
            value: what it is set to.

        Raises:
            ConfigError: if a part of the path is set already, and to no table.
        """
        return ComponentSpec(name=self.name, params=_with(self.params, path.split("."), value, f"{self.name}.{path}"))


def _with(table: dict[str, Any], path: list[str], value: Any, owner: str) -> dict[str, Any]:
    name, *inner = path
    if not inner:
        return {**table, name: value}
    there = table.get(name, {})
    if isinstance(there, str):  # a component by its name
        there = {"name": there}
    if not isinstance(there, dict):
        raise ConfigError(f"{owner!r} can't be set, for {name!r} is {there!r} and no table; set it as a whole")
    return {**table, name: _with(there, inner, value, owner)}


class Experiment(BaseModel):
    """Which components an episode is made of. Every field has a default that needs no key and no GPU."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    agent: ComponentSpec = ComponentSpec(name="polyfold")
    simulator: ComponentSpec = ComponentSpec(name="xpbd")
    fabric: ComponentSpec = ComponentSpec(name=USUAL)
    """What the garment is made of; ``usual``, or a table of parameters without a name: what its kind usually is."""
    segmenter: ComponentSpec = ComponentSpec(name="colour")
    grounding: ComponentSpec = ComponentSpec(name="polygon")
    planner: ComponentSpec = ComponentSpec(name="hierarchical")
    policy: ComponentSpec = ComponentSpec(name="affordance-pair")
    llm: ComponentSpec = ComponentSpec(name="offline")
    guidance: Literal["steps", "final"] = "steps"
    """What agents that need guidance get: accurate subgoals, or the final goal alone."""

    @field_validator("fabric", mode="before")
    @classmethod
    def _usual_unless_named(cls, value: Any) -> Any:
        return {"name": USUAL, **value} if isinstance(value, dict) and "name" not in value else value

    @classmethod
    def of(cls, **settings: Any) -> Experiment:
        """Build from keyword settings.

        Raises:
            ConfigError: naming the setting that is unknown or wrong.
        """
        return _validated(settings, "the experiment")

    @classmethod
    def load(cls, path: str | Path) -> Experiment:
        """Read an experiment from a TOML file. Raises ConfigError with the file and the wrong line or setting."""
        return _validated(read_toml(path), str(path))

    def override(self, settings: dict[str, str | dict[str, Any] | ComponentSpec]) -> Experiment:
        """A copy with some components replaced."""
        return Experiment.of(**{**self.model_dump(), **settings})


def read_toml(path: str | Path) -> dict[str, Any]:
    """The content of a TOML file. Raises ConfigError with the file and the line that is wrong."""
    if not isinstance(path, str | PathLike):
        raise ConfigError(f"{path!r} is no path; give that of a TOML file")
    path = Path(path)
    text = ""
    try:
        text = path.read_text("utf-8-sig")
        return tomllib.loads(text)
    except OSError as error:
        raise ConfigError(file_problem(error, path)) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} {toml_problem(error, text)}") from error


def _validated(settings: dict[str, Any], source: str) -> Experiment:
    try:
        return Experiment(**settings)
    except ValidationError as error:
        raise ConfigError(f"{source} {validation_problem(error, Experiment.model_fields)}") from error
