"""How one implementation of a hook is called, apart from all others, so that its errors stay its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pluggy


def implementations(manager: pluggy.PluginManager, hook: str, plugin: object = None) -> list[pluggy.HookImpl]:
    """The implementations of a hook in the order they were registered; those of one plugin, if one is given."""
    caller: pluggy.HookCaller = getattr(manager.hook, hook)
    return [found for found in caller.get_hookimpls() if plugin is None or found.plugin is plugin]


def call(implementation: pluggy.HookImpl, values: Mapping[str, Any]) -> None:
    """Call an implementation with those of the values that it asks for.

    pluggy's own caller leaves out arguments with a default; here they are given too, so that ``role="method"`` does not
    call every episode the method's.
    """
    defaults = {name: values[name] for name in implementation.kwargnames if name in values}
    implementation.function(*(values[name] for name in implementation.argnames), **defaults)
