"""Checks by kind of component: each a function that raises a ConformanceError."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

from polyfold.plugins.hookspecs import KINDS
from polyfold.testing._subjects import Subject


@dataclass(frozen=True)
class Check:
    """One thing that a component must do: said in words, and looked at."""

    says: str
    run: Callable[[Subject], None]


_CHECKS: dict[str, list[Check]] = defaultdict(list)
EVERY = "every"
"""Stands for all kinds."""


def checks(kind: str, says: str) -> Callable[[Callable[[Subject], None]], Callable[[Subject], None]]:
    """Decorate a check of a kind of component."""

    def add(function: Callable[[Subject], None]) -> Callable[[Subject], None]:
        _CHECKS[kind].append(Check(says, function))
        return function

    return add


def checks_of(kind: str) -> list[Check]:
    """The checks of a kind of component."""
    for name in (EVERY, *KINDS):
        import_module(f"polyfold.testing._kinds.{_HOMES.get(name, name)}")
    return [*_CHECKS[EVERY], *_CHECKS[kind]]


_HOMES = {"cameras": "hardware", "robots": "hardware", "metrics": "scores", "criteria": "scores", "tasks": "scores"}
