"""``polyfold plugins``: what is installed, where it comes from, and what is wrong with it."""

from __future__ import annotations

import argparse
import json
import shlex
from typing import Any

from polyfold import plugins
from polyfold.errors import PluginError
from polyfold.plugins.hookspecs import KINDS


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("show", nargs="?", choices=["show"], help="one component and its parameters")
    parser.add_argument("name", nargs="?", help="of the component, such as csam+caso")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--traceback", action="store_true", help="show the tracebacks of broken plugins")


def run(arguments: argparse.Namespace) -> int:
    """List plugins and components, or show one. A broken plugin is listed, not fatal."""
    if arguments.show is not None:
        return _show(arguments.name)
    listing = _listing()
    if arguments.json:
        print(json.dumps(listing, indent=2))
        return 0
    for kind in (*KINDS, "commands"):
        components = [component for component in listing["components"] if component["kind"] == kind]
        if not components:
            continue
        print(kind)
        for component in components:
            missing = (
                f"  [needs: pip install {' '.join(map(shlex.quote, component['missing']))}]"
                if component["missing"]
                else ""
            )
            source = f"  ({component['distribution']})" if component["distribution"] != "polyfold" else ""
            print(f"  {component['name']:<16} {component['summary']}{source}{missing}")
    print("plugins")
    for plugin in listing["plugins"]:
        print(f"  {plugin['name']:<16} {plugin['distribution']} {plugin['version']}  {plugin['module']}")
        for problem in plugin["problems"]:
            print(f"    ! {problem['summary']}")
            if arguments.traceback and problem["traceback"]:
                print("      " + problem["traceback"].rstrip().replace("\n", "\n      "))
    return 0


def _show(name: str | None) -> int:
    """Everything that is called so: what it is, who made it, and what can be set."""
    from polyfold.api import describe

    if name is None:
        raise PluginError("plugins show needs a component's name, such as csam+caso; polyfold plugins lists them")
    print(describe(name))
    return 0


def _listing() -> dict[str, Any]:
    catalog = plugins.catalog()
    components = [
        {
            "kind": kind,
            "name": entry.name,
            "summary": entry.summary,
            "target": entry.target if isinstance(entry.target, str) else repr(entry.target),
            "plugin": entry.plugin.name,
            "distribution": entry.plugin.distribution,
            "version": entry.plugin.version,
            "needs": list(entry.needs),
            "missing": entry.missing_packages(),
        }
        for kind in (*KINDS, "commands", "prompts")
        for name in sorted(catalog.components[kind])
        for entry in catalog.components[kind][name]
    ]
    return {
        "plugins": [
            {
                "name": plugin.name,
                "distribution": plugin.distribution,
                "version": plugin.version,
                "module": plugin.module,
                "problems": [vars(problem) for problem in plugin.problems],
            }
            for plugin in catalog.plugins
        ],
        "components": components,
    }
