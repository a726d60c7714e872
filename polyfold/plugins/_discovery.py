"""Loads entry points one by one and lets each register: whatever goes wrong is recorded against that plugin alone."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable, Iterable
from importlib.metadata import EntryPoint, entry_points
from typing import Any

import pluggy

from polyfold.errors import did_you_mean
from polyfold.plugins import hookspecs
from polyfold.plugins._catalog import Catalog, Plugin, Problem

GROUP = "polyfold"
BUNDLED = "polyfold"
"""The distribution whose plugins come with PolyFold."""


def new_manager(blocked: Iterable[str] = ()) -> pluggy.PluginManager:
    """A plugin manager that knows every hook and keeps out plugins by name or distribution."""
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(hookspecs)
    for name in blocked:
        manager.set_blocked(name)
    return manager


def disabled_by_environment() -> set[str]:
    """Names of plugins or distributions in ``$POLYFOLD_DISABLE``, separated by commas."""
    return {name.strip() for name in os.environ.get("POLYFOLD_DISABLE", "").split(",") if name.strip()}


def discover(catalog: Catalog, manager: pluggy.PluginManager, third_party: bool) -> None:
    """Load every entry point into a catalog and a manager, the bundled ones first.

    Args:
        catalog: what is found is added to it.
        manager: loaded plugins are registered with it, each under the label of its record.
        third_party: whether plugins of other distributions count.
    """
    for entry_point in sorted(entry_points(group=GROUP), key=_order):
        plugin = _described(entry_point)
        if manager.is_blocked(plugin.name) or manager.is_blocked(plugin.distribution):
            continue
        if third_party or plugin.distribution == BUNDLED:
            catalog.plugins.append(plugin)
            _load(catalog, manager, plugin, entry_point)


def _order(entry_point: EntryPoint) -> tuple[bool, str, str]:
    plugin = _described(entry_point)
    return plugin.distribution != BUNDLED, plugin.name, plugin.distribution


def _described(entry_point: EntryPoint) -> Plugin:
    distribution = entry_point.dist
    name, version = (distribution.name, distribution.version) if distribution else ("", "")
    return Plugin(entry_point.name, name, version, entry_point.value)


def _load(catalog: Catalog, manager: pluggy.PluginManager, plugin: Plugin, entry_point: EntryPoint) -> None:
    try:
        target = entry_point.load()
    except Exception as error:
        plugin.problems.append(Problem(_load_failure(error, plugin), traceback.format_exc()))
        return
    try:
        manager.register(target, plugin.label)
    except (pluggy.PluginValidationError, ValueError) as error:
        manager.unregister(name=plugin.label)
        plugin.problems.append(
            Problem(f"a hook has the wrong arguments ({error}); compare with polyfold.plugins.hookspecs")
        )
        return
    _check_hooks(manager, plugin, target)
    for kind in (*hookspecs.KINDS, "commands", "prompts"):
        _call_registration(manager, plugin, target, f"register_{kind}", catalog.registrar(kind, plugin))


def _load_failure(error: Exception, plugin: Plugin) -> str:
    if isinstance(error, ModuleNotFoundError) and error.name:
        return (
            f"it could not be imported: the module {error.name!r} is missing; install it with: pip install {error.name}"
        )
    return (
        f"it could not be imported ({type(error).__name__}: {error}); "
        f"update it, uninstall it or set POLYFOLD_DISABLE={plugin.name}"
    )


def _check_hooks(manager: pluggy.PluginManager, plugin: Plugin, target: Any) -> None:
    """Record hooks that nobody would call: misspelt ones, and functions that lack the mark."""
    known = [name for name in dir(hookspecs) if manager.parse_hookspec_opts(hookspecs, name) is not None]
    for caller in manager.get_hookcallers(target) or ():
        if not caller.has_spec():
            hint = did_you_mean(caller.name, known)
            plugin.problems.append(Problem(f"it implements the unknown hook {caller.name!r}; {hint}"))
    for name in known:
        function = getattr(target, name, None)
        if callable(function) and manager.parse_hookimpl_opts(target, name) is None:
            plugin.problems.append(Problem(f"its function {name!r} lacks @hookimpl, so it was not called; decorate it"))


def _call_registration(
    manager: pluggy.PluginManager, plugin: Plugin, target: Any, hook: str, register: Callable[..., None]
) -> None:
    """Call one plugin's hook and no other's, so that its errors stay its own."""
    others = [other for other in manager.get_plugins() if other is not target]
    try:
        manager.subset_hook_caller(hook, others)(register=register)
    except Exception as error:
        summary = f"{hook} failed ({type(error).__name__}: {error}); update or uninstall it"
        plugin.problems.append(Problem(summary, traceback.format_exc()))
