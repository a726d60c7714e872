"""One model of an experiment: which components, with which parameters; TOML in and out."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from operator import index
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from polyfold.errors import ConfigError, validation_problem
from polyfold.errors._hints import file_problem, misplaced_truth, toml_problem, whole_number_problem

__all__ = ["ComponentSpec", "Experiment", "read_toml"]

USUAL = "usual"
"""Stands for the fabric that a kind of garment is usually made of; no component is called so."""


class Settings(BaseModel):
    """Settings that answer a wrong one with a ConfigError which says what to do, however they are given.

    Keywords have no source to name; ``model_validate(settings, context={"source": "study.toml"})`` names theirs.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="wrap")
    @classmethod
    def _answered(cls, given: Any, validate: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        source = (info.context or {}).get("source", f"the {cls.__name__.lower()}")
        if isinstance(given, Mapping) and (wrong := misplaced_truth(given, cls.model_fields)):
            raise ConfigError(f"{source} {wrong}")
        try:
            return validate(given)
        except ValidationError as error:
            raise ConfigError(f"{source} {validation_problem(error, cls.model_fields)}") from error


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


class Experiment(Settings):
    """Which components an episode is made of. Every field has a default that needs no key and no GPU."""

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
        return cls(**settings)

    @classmethod
    def load(cls, path: str | Path) -> Experiment:
        """Read an experiment from a TOML file. Raises ConfigError with the file and the wrong line or setting."""
        return cls.model_validate(read_toml(path), context={"source": str(path)})

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


def checked_seed(seed: object) -> int:
    """A seed as Python's own whole number. Raises ConfigError for what is none, as ``--seed`` is answered."""
    if problem := whole_number_problem(seed):
        raise ConfigError(f"seed: {problem}")
    return index(seed)  # pyright: ignore[reportArgumentType]
