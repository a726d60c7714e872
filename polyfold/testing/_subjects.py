"""What is checked: the components of a plugin, each with the parameters that it is made with."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polyfold import plugins
from polyfold.errors import ConfigError, PluginError, did_you_mean
from polyfold.plugins._registry.catalog import Catalog, Plugin
from polyfold.plugins._traits import Configurable, ReadsFiles
from polyfold.plugins.hookspecs import KINDS, singular


class ConformanceError(AssertionError):
    """A check that failed: what is wrong, where, and what to change."""


@dataclass(frozen=True)
class Subject:
    """One component.

    Attributes:
        kind: one of :data:`polyfold.plugins.hookspecs.KINDS`.
        name: as registered.
        params: values for its ``Config``.
    """

    kind: str
    name: str
    params: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{singular(self.kind)} {self.name}"

    def lacking(self) -> str | None:
        """Why it can't be tried here; None if it can."""
        if missing := plugins.catalog().components[self.kind][self.name.partition(":")[0]][0].missing_packages():
            return f"needs {', '.join(missing)}"
        cls = self.cls()
        if self.kind == "simulators" and not getattr(cls, "unattended", True):
            return "is a real table, which nothing here may move"
        if not isinstance(cls, Configurable):
            return None
        required = [name for name, field in cls.Config.model_fields.items() if field.is_required()]
        missing = [name for name in required if name not in self.params]
        if missing:
            return f"needs params={{'{self}': {{{', '.join(f'{name!r}: …' for name in missing)}}}}}"
        return self._lacking_files(cls)

    def _lacking_files(self, cls: Any) -> str | None:
        """Which files it says that it lacks, such as weights that everybody makes for themselves."""
        if not isinstance(cls, ReadsFiles):
            return None
        config = plugins.configured(self.kind, self.name, self.params)[1]
        try:
            cls.files_read(config)
        except ConfigError as error:
            return str(error)
        return None

    def make(self) -> Any:
        """A new one, as the host makes it."""
        return plugins.create(self.kind, self.name, self.params)

    def cls(self) -> Any:
        """Its class; None for a suite of tasks, which is a file."""
        if self.kind == "tasks":
            return None
        return plugins.component_class(self.kind, self.name.partition(":")[0])

    def require(self, holds: Any, method: str, wrong: str, advice: str) -> None:
        """Raise a :class:`ConformanceError` that names the method's place, unless something holds."""
        if not holds:
            raise ConformanceError(
                f"the {singular(self.kind)} {self.name!r} ({self._place(method)}): {wrong}. {advice}"
            )

    def _place(self, method: str) -> str:
        found = inspect.unwrap(getattr(self.cls(), method, None) or self.cls())
        try:
            file, line = inspect.getsourcefile(found), inspect.getsourcelines(found)[1]
        except (TypeError, OSError):
            return method
        return f"{Path(file or '').name}:{line}, {method}"


def subjects(name: str, params: Mapping[str, Mapping[str, Any]] | None = None) -> list[Subject]:
    """The components of a plugin, distribution, or of this one name, for example ``middle`` or ``policy middle``.

    Args:
        name: what to look for.
        params: parameters by component, ``{"policy mine": {"file": "weights.safetensors"}}``.

    Raises:
        PluginError: if there is no such plugin; if it is broken or registers nothing; the message says why.
    """
    params = dict(params or {})
    catalog, owners = _looked_at(name)
    found = [
        Subject(kind, entry.name, params.pop(f"{singular(kind)} {entry.name}", {}))
        for kind in KINDS
        for entries in catalog.components[kind].values()
        for entry in entries
        if name in (entry.plugin.name, entry.plugin.distribution, entry.name, f"{singular(kind)} {entry.name}")
    ]
    for plugin in owners:
        _refuse_broken(plugin)
    if params:
        raise PluginError(f"{name!r} has no {sorted(params)[0]!r} to give parameters to; name them like 'policy mine'")
    if not found:
        raise PluginError(_nothing(name, owners))
    return found


def _looked_at(name: str) -> tuple[Catalog, list[Plugin]]:
    """The catalog, and the plugins that are meant; what is wrong with these is an error here and no warning as well."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        catalog = plugins.catalog()
    owners = [plugin for plugin in catalog.plugins if name in (plugin.name, plugin.distribution)]
    told = {f"plugin {plugin.label}: {problem.summary}" for plugin in owners for problem in plugin.problems}
    for warning in warned:
        if str(warning.message) not in told:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)
    return catalog, owners


def _refuse_broken(plugin: Plugin) -> None:
    if plugin.problems:
        raise PluginError(f"the plugin {plugin.label} has a problem: {plugin.problems[0].summary}")


def _nothing(name: str, owners: list[Plugin]) -> str:
    if owners:
        return (
            f"the plugin {owners[0].label} registers nothing; write hooks such as register_policies(register) in "
            f"{owners[0].module}, decorated with @hookimpl (polyfold.plugins.hookspecs lists them)"
        )
    known = sorted({label for plugin in plugins.catalog().plugins for label in (plugin.name, plugin.distribution)})
    return (
        f"no plugin or component is called {name!r}; {did_you_mean(name, known)}. Is it installed here? "
        "pip install -e . in its folder"
    )
