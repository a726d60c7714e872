"""Objects of this process that watch runs without being plugins."""

from __future__ import annotations

import inspect

import pluggy

from polyfold.errors import PluginError, did_you_mean
from polyfold.plugins import hookspecs

EVENTS = tuple(name for name in vars(hookspecs) if name.startswith("on_"))
"""Names of the hooks that observe."""


class Observers(pluggy.PluginManager):
    """Objects whose ``on_*`` methods are called as plugins' hooks are, and need no mark."""

    def __init__(self) -> None:
        super().__init__(hookspecs.hookspec.project_name)
        self.add_hookspecs(hookspecs)
        self._watching: list[tuple[object, _Methods]] = []

    def parse_hookimpl_opts(self, plugin: object, name: str) -> pluggy.HookimplOpts | None:
        """Take the methods that are named like events."""
        if name not in EVENTS or name not in vars(plugin):
            return None
        return pluggy.HookimplOpts(
            wrapper=False, hookwrapper=False, optionalhook=False, tryfirst=False, trylast=False, specname=None
        )

    def add(self, observer: object) -> None:
        """Call an object's methods from now on. Raises PluginError if none would ever be called."""
        kind, methods = type(observer).__name__, _Methods(observer)
        if not vars(methods):
            misspelt = next((name for name in dir(observer) if name.startswith("on_")), "")
            hint = did_you_mean(misspelt, EVENTS, otherwise="give it one")
            raise PluginError(f"the observer {kind} has none of the methods {', '.join(EVENTS)}; {hint}")
        try:
            self.register(methods, f"{kind} at {id(methods):#x}")
        except pluggy.PluginValidationError as error:
            raise PluginError(
                f"the observer {kind} asks for what no event has ({error}); compare with polyfold.plugins.hookspecs"
            ) from error
        self._watching.append((observer, methods))

    def discard(self, observer: object) -> None:
        """Undo the last :meth:`add` of an object. Raises PluginError if there is none."""
        for index in reversed(range(len(self._watching))):
            found, methods = self._watching[index]
            if found is observer:
                del self._watching[index]
                self.unregister(methods)
                return
        raise PluginError(f"this {type(observer).__name__} does not observe; there is nothing to stop")


class _Methods:
    """An observer's methods; equal to no other's, whatever the observer's own class calls equal."""

    def __init__(self, observer: object) -> None:
        for name in EVENTS:
            method = getattr(observer, name, None)
            if inspect.isfunction(method) or inspect.ismethod(method):
                setattr(self, name, method)
