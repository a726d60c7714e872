"""The reference: a page for every module that has public names."""

from __future__ import annotations

import ast
import inspect
import types
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

from docs.making import contents

MODULES = (
    "api", "playground", "studies", "analysis", "viz", "plugins", "plugins.interfaces", "plugins.hardware",
    "plugins.hookspecs", "testing", "types", "geometry", "polygon", "garments", "tasks", "evaluation", "prompts",
    "rollout", "logs", "config", "errors",
)  # fmt: skip
"""From what users meet first to what it stands on."""


def names() -> list[str]:
    """The pages, by module."""
    return [f"polyfold.{name}" for name in MODULES]


def index() -> str:
    """Where each name of the root is told of."""
    from polyfold import _HOMES, __all__

    homes = {name: module for module, listed in _HOMES.items() for name in listed}
    rows = [f"| `polyfold.{name}` | {{py:obj}}`{homes[name]}.{name}` |" for name in __all__ if name in homes]
    rows += ["| `polyfold.view` | [polyfold.viz](polyfold.viz.md) |"]
    rows += ["| `polyfold.plugins` | [polyfold.plugins](polyfold.plugins.md) |"]
    told = "Everything that a notebook needs stands in the root, and is loaded when it is first used."
    return "\n".join(
        ["# Reference", "", told, "", "| name | told of under |", "|---|---|", *rows, "", contents(names())]
    )


def page(module: str) -> str:
    """The module in its own words, then each public name."""
    found = import_module(module)
    told = ["```{eval-rst}", f".. automodule:: {module}", "   :no-members:", ""]
    if module == "polyfold.plugins.hookspecs":
        listed = [name for name, value in vars(found).items() if inspect.isfunction(value) and name in _hooks(found)]
    else:
        listed = found.__all__
    for name in listed:
        told += _entry(module, name, getattr(found, name))
    return "\n".join([f"# {module}", "", *told, "```", ""])


def _hooks(module) -> list[str]:
    return [name for name in vars(module) if name.startswith(("register_", "on_"))]


def _entry(module: str, name: str, value: Any) -> list[str]:
    if inspect.isclass(value):
        directive = "autoexception" if issubclass(value, BaseException) else "autoclass"
        return [f".. {directive}:: {module}.{name}", ""]
    if callable(value) and hasattr(value, "__name__") and not isinstance(value, types.GenericAlias):
        return [f".. autofunction:: {module}.{name}", ""]
    return [f".. py:data:: {module}.{name}", "", *(f"   {line}" for line in words_of(module, name).splitlines()), ""]


def words_of(module: str, name: str) -> str:
    """What stands below the assignment of a constant or an alias, in the file of the package that makes it."""
    found = Path(import_module(module).__file__ or "")
    for file in sorted(found.parent.rglob("*.py")) if found.name == "__init__.py" else [found]:
        body = ast.parse(file.read_text("utf-8")).body
        for statement, after in pairwise(body):
            if isinstance(statement, ast.Assign | ast.AnnAssign) and name in _targets(statement):
                said = after.value if isinstance(after, ast.Expr) else None
                return inspect.cleandoc(str(said.value)) if isinstance(said, ast.Constant) else ""
    return ""


def _targets(statement: ast.Assign | ast.AnnAssign) -> list[str]:
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    return [ast.unparse(target) for target in targets]
