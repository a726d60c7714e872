"""Telling observers what happens: an observer's error is recorded against it and never disturbs a run."""

from __future__ import annotations

import traceback
import warnings
from collections.abc import Iterator
from typing import Any

import pluggy

from polyfold.plugins import hookspecs
from polyfold.plugins._catalog import Plugin, Problem

PREFIX = "on_"
"""What the names of all hooks begin with that observe."""


class Observers(pluggy.PluginManager):
    """Objects of this process that watch runs: their ``on_*`` methods need no mark."""

    def __init__(self) -> None:
        super().__init__(hookspecs.hookspec.project_name)
        self.add_hookspecs(hookspecs)

    def parse_hookimpl_opts(self, plugin: object, name: str) -> pluggy.HookimplOpts | None:
        """Take every method that is named like a hook that observes."""
        if not name.startswith(PREFIX) or not callable(getattr(plugin, name, None)):
            return None
        return pluggy.HookimplOpts(
            wrapper=False, hookwrapper=False, optionalhook=False, tryfirst=False, trylast=False, specname=None
        )


def tell(managers: tuple[pluggy.PluginManager, ...], plugins: list[Plugin], hook: str, values: dict[str, Any]) -> None:
    """Call a hook of every observer with those of the values that it asks for.

    Args:
        managers: what observers are registered with.
        plugins: records of the plugins, by label the names they are registered under.
        hook: name of the hook.
        values: its arguments by name.
    """
    for implementation in _implementations(managers, hook):
        try:
            implementation.function(*(values[name] for name in implementation.argnames))
        except Exception as error:
            summary = f"its observer {hook} failed ({type(error).__name__}: {error}); the run went on without it"
            _record(plugins, implementation.plugin_name, summary)


def _implementations(managers: tuple[pluggy.PluginManager, ...], hook: str) -> Iterator[pluggy.HookImpl]:
    for manager in managers:
        yield from getattr(manager.hook, hook).get_hookimpls()


def _record(plugins: list[Plugin], label: str, summary: str) -> None:
    """Record a problem against its plugin, and warn of it the first time."""
    for plugin in plugins:
        if plugin.label == label:
            if any(problem.summary == summary for problem in plugin.problems):
                return
            plugin.problems.append(Problem(summary, traceback.format_exc()))
    warnings.warn(f"plugin {label}: {summary}", stacklevel=4)
