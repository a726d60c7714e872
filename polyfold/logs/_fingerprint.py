"""The fingerprint of a run: what its results depend on besides the configuration.

The same fingerprint guards a resumed run and keys the cache of references, so that neither mixes what different code
made.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping

from pydantic import BaseModel, ConfigDict, Field

UNREADABLE = "unreadable"
"""Stands for the digest of what can't be read: nobody knows whether it changed."""


class GitState(BaseModel):
    """The checkout that a package is used from."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    commit: str
    dirty: bool


class Fingerprint(BaseModel):
    """What results depend on besides the configuration.

    Attributes:
        distributions: versions by name: Python, PolyFold, those of the plugins in use, and of numerical libraries.
        sources: SHA-256 by package: of the core's that decide results, and of every plugin in use.
        prompts: SHA-256 by ``role@version``, of those in use.
        files: SHA-256 by package and name of what components read besides their source, such as weights.
        git: commit and whether it had local changes, by the first package that is used from a checkout.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    distributions: dict[str, str] = Field(default_factory=dict)
    sources: dict[str, str] = Field(default_factory=dict)
    prompts: dict[str, str] = Field(default_factory=dict)
    files: dict[str, str] = Field(default_factory=dict)
    git: dict[str, GitState] = Field(default_factory=dict)

    def differences(self, other: Fingerprint, with_new: bool = True) -> tuple[str, ...]:
        """What is otherwise in ``other``, one line each; what could not be read counts as otherwise.

        A commit alone is a difference too, although :meth:`digest` is the same: it may change what is not looked at.

        Args:
            other: the later one.
            with_new: whether what only ``other`` depends on is a difference.
        """
        lines: list[str] = []
        for what, mine, theirs in (
            ("version of", self.distributions, other.distributions),
            ("source of", self.sources, other.sources),
            ("prompt", self.prompts, other.prompts),
            ("file", self.files, other.files),
            ("commit of", _shown(self.git), _shown(other.git)),
        ):
            for name in sorted({*mine, *theirs} if with_new else mine):
                old, new = mine.get(name, "absent"), theirs.get(name, "absent")
                if old != new or new == UNREADABLE:
                    lines.append(f"{what} {name}: {_short(old)} then, {_short(new)} now")
        return tuple(lines)

    def digest(self) -> str:
        """SHA-256 of all that decides results; a commit alone that changes no source does not."""
        content = self.model_dump(mode="json", exclude={"git"})
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _shown(states: Mapping[str, GitState]) -> dict[str, str]:
    return {name: f"{state.commit[:12]}{' with changes' if state.dirty else ''}" for name, state in states.items()}


def _short(value: str) -> str:
    """A digest by its first letters, anything else whole."""
    return value[:12] if len(value) == 64 else value
