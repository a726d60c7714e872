"""The catalog of components with their provenance: plain records, filled by :mod:`polyfold.plugins`."""

from __future__ import annotations

import shlex
from collections import defaultdict
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from typing import TYPE_CHECKING, Any

from polyfold.errors import PluginError
from polyfold.plugins._registry.naming import refuse_name, refuse_target
from polyfold.plugins.hookspecs import KINDS

if TYPE_CHECKING:
    from packaging.requirements import Requirement

SESSION = "<session>"
"""Stands in the place of a plugin's name for what is registered by hand."""


@dataclass(frozen=True)
class Problem:
    """Something wrong with a plugin: one sentence that says what to do, and the traceback if there was one."""

    summary: str
    traceback: str = ""


@dataclass
class Plugin:
    """Where components come from: entry point, distribution, version, and what is wrong with it."""

    name: str
    distribution: str
    version: str
    module: str
    problems: list[Problem] = field(default_factory=list)

    @property
    def to_disable(self) -> str:
        """What to name in ``$POLYFOLD_DISABLE``: the distribution, since two may have plugins of one name."""
        return self.distribution or self.name

    @property
    def is_session(self) -> bool:
        """Whether it stands for what is registered by hand."""
        return (self.name, self.distribution) == (SESSION, "")

    @property
    def label(self) -> str:
        """Name with distribution and version, for messages."""
        return f"{self.name!r} ({self.distribution} {self.version})" if self.distribution else f"{self.name!r}"


@dataclass(frozen=True)
class Component:
    """One registration: a name, what it stands for, and who registered it."""

    name: str
    target: type | str
    summary: str
    needs: tuple[str, ...]
    plugin: Plugin

    def missing_packages(self) -> list[str]:
        """Requirements in ``needs`` that no installed distribution meets."""
        return [package for package in self.needs if not _installed(package)]

    def refuse_if_incomplete(self, what: str) -> None:
        """Raises PluginError with the pip command if ``what``, which this is, can't do without something missing."""
        if missing := self.missing_packages():
            raise PluginError(
                f"{what} needs {', '.join(missing)}; install with: pip install {' '.join(map(shlex.quote, missing))}"
            )

    def load(self, what: str) -> Any:
        """The class behind it. Raises PluginError if ``what``, which this is, can't be imported."""
        if isinstance(self.target, type):
            return self.target
        module, _, attribute = self.target.partition(":")
        try:
            return getattr(import_module(module), attribute)
        except (Exception, SystemExit) as error:
            why, target = f"{type(error).__name__}: {error}", self.target
            raise PluginError(
                f"{what} of {self.plugin.label} can't be loaded from {target!r} ({why}); update or mend that plugin"
            ) from error


def _installed(package: str) -> bool:
    """Whether a requirement is met, with all that its extras ask for: ``polyfold[torch]`` is, once torch is there."""
    from packaging.requirements import InvalidRequirement, Requirement

    try:
        wanted = Requirement(package)
        found = distribution(wanted.name)
        if not wanted.specifier.contains(found.version, prereleases=True):
            return False
        listed = [Requirement(text) for text in found.requires or ()]
    except (PackageNotFoundError, InvalidRequirement):
        return False
    return all(
        _installed(str(_without_marker(requirement)))
        for extra in wanted.extras
        for requirement in listed
        if requirement.marker is not None
        and requirement.marker.evaluate({"extra": extra})
        and not requirement.marker.evaluate({"extra": ""})
    )


def _without_marker(requirement: Requirement) -> Requirement:
    plain = copy(requirement)
    plain.marker = None
    return plain


class Catalog:
    """Plugins found and components registered: ``components[kind][name]`` lists who registered the name."""

    def __init__(self) -> None:
        self.plugins: list[Plugin] = []
        self.components: dict[str, dict[str, list[Component]]] = defaultdict(dict)

    def registrar(self, kind: str, plugin: Plugin) -> Callable[..., None]:
        """The ``register`` function that a plugin's hook is called with."""

        def register(name: str, target: type | str, summary: str = "", needs: tuple[str, ...] | list[str] = ()) -> None:
            refuse_name(kind, name)
            if isinstance(target, str) and ":" not in target:
                raise PluginError(f"the target {target!r} of {name!r} must read 'package.module:Class'")
            if kind in KINDS:  # a verb may be a module
                refuse_target(kind, name, target)
            self.add(kind, Component(name, target, summary, tuple(needs), plugin))

        return register

    def add(self, kind: str, component: Component) -> None:
        """Add a registration.

        One by hand takes the place of those of its name. Else a name that is taken is recorded against both plugins, or
        against the one that registers it twice.
        """
        entries = self.components[kind].setdefault(component.name, [])
        if component.plugin.is_session:
            entries.clear()
        elif entries:
            owner, other = component.plugin, entries[0].plugin
            if owner is other:
                owner.problems.append(Problem(f"it registers the {kind} name {component.name!r} twice; {RENAME}"))
            else:
                for one, two in ((owner, other), (other, owner)):
                    one.problems.append(
                        Problem(
                            f"its {kind} name {component.name!r} is also registered by {two.label}; "
                            "uninstall or disable one of them"
                        )
                    )
        entries.append(component)


RENAME = "give one of the two another name, or take it out of the hook"
"""What to do about a name that one plugin registers twice."""
