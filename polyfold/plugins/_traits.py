"""What components may have besides the methods of their kind; see :mod:`polyfold.plugins.interfaces`.

They stand apart so that listing and constructing components loads neither numpy nor a component.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, runtime_checkable

if TYPE_CHECKING:
    from pydantic import BaseModel


@runtime_checkable
class Configurable(Protocol):
    """A component with parameters: the fields of a pydantic model; an instance of it is the constructor's argument."""

    Config: ClassVar[type[BaseModel]]


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
