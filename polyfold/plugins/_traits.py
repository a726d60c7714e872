"""What components may have besides the methods of their kind; see :mod:`polyfold.plugins.interfaces`.

They stand apart so that listing and constructing components loads neither numpy nor a component.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, runtime_checkable

if TYPE_CHECKING:
    from pydantic import BaseModel


@runtime_checkable
class Configurable(Protocol):
    """A component with parameters: the fields of a pydantic model; an instance of it is the constructor's argument."""

    Config: ClassVar[type[BaseModel]]


@runtime_checkable
class MovedParameters(Protocol):
    """A component that once had parameters which now stand elsewhere: old name -> where, ``fabric.thickness``."""

    moved: ClassVar[Mapping[str, str]]


@runtime_checkable
class MadeOf(Protocol):
    """A kind of garment that says which fabric it is usually made of, by name; others are made of ``poplin``."""

    default_fabric: ClassVar[str]


@runtime_checkable
class TakesArgument(Protocol):
    """A component that is chosen with an argument, as ``litellm:openai/gpt-4o``: the field of ``Config`` it sets."""

    argument: ClassVar[str]


@runtime_checkable
class UsesComponents(Protocol):
    """An agent made of components: their kinds, singular, for example ``("segmenter", "policy")``.

    It is constructed as ``Class(config, segmenter=..., policy=...)`` with those that the experiment names.
    """

    uses: ClassVar[Sequence[str]]


@runtime_checkable
class ReadsFiles(Protocol):
    """A component that reads files besides its source: such as weights. They belong to a run's fingerprint."""

    @classmethod
    def files_read(cls, config: Any) -> Sequence[Path]:
        """The files that it reads with these parameters."""
        ...


@runtime_checkable
class ReadsPrompts(Protocol):
    """A component that asks a language model with prompt files. They belong to a run's fingerprint."""

    @classmethod
    def prompts_read(cls, config: Any) -> Sequence[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        ...


def moved_to(cls: Any, parameter: str) -> str | None:
    """What to do about a parameter that a component no longer has; None if it never had it."""
    place = cls.moved.get(parameter) if isinstance(cls, MovedParameters) else None
    return None if place is None else f"use {place} instead"
