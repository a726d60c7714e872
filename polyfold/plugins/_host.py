"""Discovery of plugins and the catalog of components: names become objects here and nowhere else.

Discovery is lazy and happens once per process. Every entry point is loaded on its own: a broken plugin is recorded with
its distribution, version and traceback, warned of once, and never takes the host down.
"""

from __future__ import annotations

import importlib
import inspect
import os
import traceback
import warnings
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any

import pluggy

from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import ConfigError, PluginError
from polyfold.plugins import hookspecs
from polyfold.plugins._catalog import Catalog, Component, Plugin, Problem

GROUP = "polyfold"
_explicit: list[tuple[str, Component]] = []
_observers: list[Any] = []
_third_party = True


@cache
def catalog() -> Catalog:
    """The catalog of everything that is installed; discovered on first use."""
    found = Catalog()
    disabled = {name.strip() for name in os.environ.get("POLYFOLD_DISABLE", "").split(",") if name.strip()}
    for entry_point in sorted(entry_points(group=GROUP), key=lambda ep: (not _bundled(ep), ep.name, _distribution(ep))):
        if entry_point.name in disabled or _distribution(entry_point) in disabled:
            continue
        if _third_party or _bundled(entry_point):
            _load(found, entry_point)
    for kind, component in _explicit:
        found.add(kind, component)
    for plugin in found.plugins:
        for problem in plugin.problems:
            warnings.warn(f"plugin {plugin.label}: {problem.summary}", stacklevel=2)
    return found


def refresh(third_party: bool | None = None) -> Catalog:
    """Look again, for a plugin installed since; ``third_party=False`` keeps to the bundled ones."""
    global _third_party
    if third_party is not None:
        _third_party = third_party
    importlib.invalidate_caches()
    catalog.cache_clear()
    _plugin_objects.clear()
    return catalog()


_plugin_objects: list[tuple[Plugin, Any]] = []


def _distribution(entry_point: EntryPoint) -> str:
    return entry_point.dist.name if entry_point.dist else ""


def _bundled(entry_point: EntryPoint) -> bool:
    return _distribution(entry_point) == "polyfold"


def _load(found: Catalog, entry_point: EntryPoint) -> None:
    """Load one entry point and let it register; whatever goes wrong is recorded against it."""
    version = entry_point.dist.version if entry_point.dist else ""
    plugin = Plugin(entry_point.name, _distribution(entry_point), version, entry_point.value)
    found.plugins.append(plugin)
    try:
        target = entry_point.load()
    except Exception as error:
        plugin.problems.append(Problem(_load_failure(error, plugin), traceback.format_exc()))
        return
    _register_hooks(found, plugin, target)


def _load_failure(error: Exception, plugin: Plugin) -> str:
    if isinstance(error, ModuleNotFoundError) and error.name:
        return (
            f"it could not be imported: the module {error.name!r} is missing; install it with: pip install {error.name}"
        )
    return (
        f"it could not be imported ({type(error).__name__}: {error}); "
        f"update it, uninstall it or set POLYFOLD_DISABLE={plugin.name}"
    )


def _register_hooks(found: Catalog, plugin: Plugin, target: Any) -> None:
    known = _hook_names()
    # A scratch manager validates signatures for this plugin alone, so that its errors stay its own.
    manager = pluggy.PluginManager("polyfold")
    manager.add_hookspecs(hookspecs)
    for name in dir(target):
        value = getattr(target, name, None)
        marked = callable(value) and getattr(value, "polyfold_impl", None) is not None
        if marked and name not in known:
            hint = _did_you_mean(name, known)
            plugin.problems.append(Problem(f"it implements the unknown hook {name!r}; {hint}"))
        elif callable(value) and name in known and not marked and getattr(value, "polyfold_spec", None) is None:
            plugin.problems.append(Problem(f"its function {name!r} lacks @hookimpl, so it was not called; decorate it"))
    try:
        manager.register(target)
    except pluggy.PluginValidationError as error:
        plugin.problems.append(Problem(f"a hook has the wrong arguments ({error}); compare with polyfold.hookspecs"))
        return
    for kind in (*hookspecs.KINDS, "commands", "prompts"):
        for implementation in getattr(manager.hook, f"register_{kind}").get_hookimpls():
            try:
                implementation.function(found.registrar(kind, plugin))
            except Exception as error:
                summary = f"register_{kind} failed ({type(error).__name__}: {error}); update or uninstall it"
                plugin.problems.append(Problem(summary, traceback.format_exc()))
    _plugin_objects.append((plugin, target))


def _hook_names() -> list[str]:
    return [name for name in dir(hookspecs) if getattr(getattr(hookspecs, name), "polyfold_spec", None) is not None]


def _did_you_mean(name: str, candidates: list[str]) -> str:
    close = get_close_matches(name, candidates, n=1, cutoff=0.6)
    return f"did you mean {close[0]!r}?" if close else f"the known ones are: {', '.join(candidates)}"


def register(kind: str, name: str, target: type | str, summary: str = "", needs: tuple[str, ...] = ()) -> None:
    """Register a component from a script or a notebook cell; a later registration of the name replaces the earlier.

    Args:
        kind: one of :data:`polyfold.hookspecs.KINDS`, for example ``"policies"``.
        name: what to call it.
        target: the class itself, or ``"package.module:Class"``.
        summary: one line.
        needs: distributions it needs.
    """
    _check_kind(kind)
    component = Component(name, target, summary, tuple(needs), Plugin("<session>", "", "", "registered by hand"))
    _explicit[:] = [(k, c) for k, c in _explicit if (k, c.name) != (kind, name)]
    _explicit.append((kind, component))
    refresh()


def unregister(kind: str, name: str) -> None:
    """Forget what :func:`register` added under a name. Raises PluginError if nothing was."""
    if (kind, name) not in by_hand():
        raise PluginError(f"no {hookspecs.singular(kind)} {name!r} was registered by hand; there is nothing to forget")
    _explicit[:] = [(k, c) for k, c in _explicit if (k, c.name) != (kind, name)]
    refresh()


def by_hand() -> list[tuple[str, str]]:
    """(kind, name) of what :func:`register` added in this process."""
    return [(kind, component.name) for kind, component in _explicit]


def portable() -> list[tuple[str, str, str]]:
    """(kind, name, target) of what was registered by hand and another process can import by its target."""
    found = []
    for kind, component in _explicit:
        target = component.target
        if isinstance(target, type):
            if target.__module__ == "__main__" or "<locals>" in target.__qualname__:
                continue
            target = f"{target.__module__}:{target.__qualname__}"
        found.append((kind, component.name, target))
    return found


def names(kind: str) -> list[str]:
    """Names of the usable components of a kind, sorted."""
    _check_kind(kind)
    return sorted(catalog().components[kind])


def find(kind: str, name: str) -> Component:
    """The catalog's entry for a component.

    Raises:
        PluginError: if nobody registered it, if two plugins did, or if something it needs is not installed.
    """
    _check_kind(kind)
    entries = catalog().components[kind].get(name, [])
    if not entries:
        raise PluginError(_unknown(kind, name))
    if len(entries) > 1:
        owners = " and ".join(entry.plugin.label for entry in entries)
        raise PluginError(
            f"the {hookspecs.singular(kind)} {name!r} is registered by {owners}; "
            f"uninstall one of them or disable one with POLYFOLD_DISABLE={entries[-1].plugin.name}"
        )
    missing = entries[0].missing_packages()
    if missing:
        raise PluginError(
            f"the {hookspecs.singular(kind)} {name!r} needs {', '.join(missing)}; install with: pip install {' '.join(missing)}"
        )
    return entries[0]


def _check_kind(kind: str) -> None:
    if kind not in hookspecs.KINDS:
        raise PluginError(
            f"there is no kind of component called {kind!r}; {_did_you_mean(kind, list(hookspecs.KINDS))}"
        )


def _unknown(kind: str, name: str) -> str:
    message = (
        f"no {hookspecs.singular(kind)} is called {name!r}; {_did_you_mean(name, sorted(catalog().components[kind]))}"
    )
    troubled = [plugin for plugin in catalog().plugins if plugin.problems]
    if troubled:
        listed = "; ".join(f"{plugin.label}: {plugin.problems[0].summary}" for plugin in troubled)
        message += f". A plugin that might have registered it has a problem: {listed}"
    return message


def component_class(kind: str, name: str) -> type:
    """The class behind a name. Raises PluginError as :func:`find` does, or if the class can't be imported."""
    component = find(kind, name)
    if isinstance(component.target, type):
        return component.target
    module, _, attribute = component.target.partition(":")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:
        raise PluginError(
            f"the {hookspecs.singular(kind)} {name!r} of {component.plugin.label} can't be loaded from {component.target!r} "
            f"({type(error).__name__}: {error}); reinstall or update that plugin"
        ) from error


def create(kind: str, name: str, params: Mapping[str, Any] | None = None, **components: Any) -> Any:
    """Construct a component.

    Args:
        kind: one of :data:`polyfold.hookspecs.KINDS`.
        name: registered name, optionally with an argument: ``"litellm:openai/gpt-4o"``. The argument sets the
            configuration field that the class names in its attribute ``argument``.
        params: values for the fields of the class's ``Config``.
        components: further components, for agents (see ``uses``).

    Raises:
        PluginError: see :func:`find`.
        ConfigError: if a parameter is unknown or has an impossible value; the message names it.
    """
    cls, config = configured(kind, name, params)
    return cls(**components) if config is None else cls(config, **components)


def configured(kind: str, name: str, params: Mapping[str, Any] | None = None) -> tuple[type, Any]:
    """The class behind a name and its ``Config`` with the given values, as :func:`create` takes them.

    The second is None for a class without parameters.
    """
    name, has_argument, argument = name.partition(":")
    cls = component_class(kind, name)
    values = dict(params or {})
    if has_argument:
        field = getattr(cls, "argument", None)
        if field is None:
            raise ConfigError(
                f"the {hookspecs.singular(kind)} {name!r} takes no argument; write {name!r} without ':{argument}'"
            )
        values[field] = argument
    config_class = getattr(cls, "Config", None)
    if config_class is not None:
        return cls, _configure(config_class, values, f"{hookspecs.singular(kind)} {name!r}")
    if values:
        raise ConfigError(
            f"the {hookspecs.singular(kind)} {name!r} has no parameters; remove {', '.join(sorted(values))}"
        )
    return cls, None


def create_chosen(experiment: Experiment, field: str) -> Any:
    """Construct the component that an experiment names in ``field``, for example ``"policy"``."""
    spec: ComponentSpec = getattr(experiment, field)
    return create(hookspecs.plural(field), spec.name, spec.params)


def _configure(config_class: type, values: dict[str, Any], owner: str) -> Any:
    from pydantic import ValidationError

    unknown = [key for key in values if key not in config_class.model_fields]
    if unknown:
        hint = _did_you_mean(unknown[0], list(config_class.model_fields))
        raise ConfigError(f"the {owner} has no parameter {unknown[0]!r}; {hint}")
    try:
        return config_class(**values)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"the {owner} has a bad value for {where!r}: {first['msg']}; change it") from error


def observe(observer: Any) -> None:
    """Let an object's ``on_*`` methods watch runs in this process, as a plugin's hooks do."""
    _observers.append(observer)


def unobserve(observer: Any) -> None:
    """Stop an observer added by :func:`observe`."""
    _observers.remove(observer)


def notify(hook: str, **values: Any) -> None:
    """Tell every observer; an observer's error is recorded against its plugin and warned of, nothing more."""
    catalog()
    for plugin, target in _plugin_objects:
        function = getattr(target, hook, None)
        if function is None or getattr(function, "polyfold_impl", None) is None:
            continue
        try:
            _call(function, values)
        except Exception as error:
            summary = f"its observer {hook} failed ({type(error).__name__}: {error}); the run went on without it"
            if not any(problem.summary == summary for problem in plugin.problems):
                plugin.problems.append(Problem(summary, traceback.format_exc()))
                warnings.warn(f"plugin {plugin.label}: {summary}", stacklevel=2)
    for observer in _observers:
        if hasattr(observer, hook):
            getattr(observer, hook)(**values)


def _call(function: Any, values: Mapping[str, Any]) -> None:
    """Call a hook with the arguments it asks for; like pluggy, a hook may take fewer than the specification."""
    wanted = inspect.signature(function).parameters
    function(**{name: value for name, value in values.items() if name in wanted})
