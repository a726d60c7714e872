"""Loads entry points one by one and lets each register: whatever goes wrong is recorded against that plugin alone."""

from __future__ import annotations

import os
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stdout
from importlib.metadata import EntryPoint, entry_points
from typing import Any

import pluggy

from polyfold.errors import PluginError, did_you_mean
from polyfold.plugins import hookspecs
from polyfold.plugins._calling import call, implementations
from polyfold.plugins._registry.catalog import Catalog, Plugin, Problem

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
    clock = time.perf_counter()
    try:
        with redirect_stdout(sys.stderr):  # what a plugin prints is no part of a verb's answer
            target = entry_point.load()
    except (Exception, SystemExit) as error:
        plugin.problems.append(Problem(_load_failure(error, plugin), traceback.format_exc()))
        return
    finally:
        _mention_slowness(plugin, time.perf_counter() - clock)
    try:
        _register(manager, plugin, target)
    except (Exception, SystemExit) as error:
        plugin.problems.append(Problem(_registration_failure(error), traceback.format_exc()))
        manager.unregister(name=plugin.label)
        return
    for kind in (*hookspecs.KINDS, "commands", "prompts"):
        _call_registration(manager, plugin, target, f"register_{kind}", catalog.registrar(kind, plugin))


def _mention_slowness(plugin: Plugin, seconds: float) -> None:
    if seconds > _SLOW and plugin.distribution != BUNDLED:
        warnings.warn(
            f"the plugin {plugin.label} took {seconds:.1f} s to import, which every command waits for; it should "
            f"import what is heavy where it is used (without it: POLYFOLD_DISABLE={plugin.to_disable})",
            stacklevel=2,
        )


_SLOW = 2.0
"""An import that takes longer than this [s] is mentioned."""


def _register(manager: pluggy.PluginManager, plugin: Plugin, target: Any) -> None:
    """Register a plugin's hooks and record those that nobody would call."""
    if manager.register(target, plugin.label) is None:
        raise PluginError(f"the entry point {plugin.module!r} is None")
    plugin.problems += _uncalled_hooks(manager, target)


def _load_failure(error: BaseException, plugin: Plugin) -> str:
    missing = error.name if isinstance(error, ModuleNotFoundError) else None
    if missing and missing.partition(".")[0] == BUNDLED:
        return f"it was written for another version of polyfold (there is no {missing} in this one); update it"
    if missing:
        again = f": pip install --force-reinstall {plugin.distribution}" if plugin.distribution else ""
        return (
            f"it could not be imported: the module {missing!r} is missing; install what has it, or the plugin again, "
            f"with what it needs{again}"
        )
    return (
        f"it could not be imported ({type(error).__name__}: {error}); "
        f"update it, uninstall it or set POLYFOLD_DISABLE={plugin.to_disable}"
    )


def _registration_failure(error: BaseException) -> str:
    said = " ".join(str(error).split())
    if isinstance(error, pluggy.PluginValidationError):
        return f"a hook has the wrong arguments ({said}); compare with polyfold.plugins.hookspecs"
    return f"its hooks could not be registered ({type(error).__name__}: {said}); update or uninstall it"


def _uncalled_hooks(manager: pluggy.PluginManager, target: Any) -> Iterator[Problem]:
    """Hooks that are misspelt, that wrap others', or that lack the mark."""
    known = [name for name in dir(hookspecs) if manager.parse_hookspec_opts(hookspecs, name) is not None]
    for caller in manager.get_hookcallers(target) or ():
        for implementation in implementations(manager, caller.name, target):
            if not caller.has_spec() and not implementation.optionalhook:
                hint = did_you_mean(caller.name, known)
                yield Problem(f"it implements the unknown hook {caller.name!r}; {hint}")
            elif implementation.wrapper or implementation.hookwrapper:
                yield Problem(f"its hook {caller.name!r} is a wrapper, which is never run; write a plain function")
    for name in known:
        function = getattr(target, name, None)
        if callable(function) and manager.parse_hookimpl_opts(target, name) is None:
            yield Problem(f"its function {name!r} lacks @hookimpl, so it was not called; decorate it")


def _call_registration(
    manager: pluggy.PluginManager, plugin: Plugin, target: Any, hook: str, register: Callable[..., None]
) -> None:
    for implementation in implementations(manager, hook, target):
        try:
            with redirect_stdout(sys.stderr):
                call(implementation, {"register": register})
        except (Exception, SystemExit) as error:
            summary = f"{hook} failed ({type(error).__name__}: {error}); update or uninstall it"
            plugin.problems.append(Problem(summary, traceback.format_exc()))
