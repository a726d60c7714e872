"""A component in words: what it is, who made it, and what can be set."""

from __future__ import annotations

import inspect
import json
import types
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import PluginError, did_you_mean
from polyfold.plugins._traits import Configurable
from polyfold.plugins.hookspecs import KINDS, singular


@dataclass(frozen=True)
class Parameter:
    """What can be set of a component.

    Attributes:
        name: of the parameter.
        values: what it may be, in words.
        default: as JSON; ``…`` where it must be given, empty for none.
        description: what it is, with its unit.
        place: what stands before its name after ``--set``; empty where it is set in a table of another component's.
    """

    name: str
    values: str
    default: str
    description: str
    place: str


@dataclass(frozen=True)
class About:
    """One component.

    Attributes:
        kind: for example ``policy``.
        name: what it is called.
        summary: one line.
        plugin: which plugin registers it, with the version.
        words: the first paragraph of its documentation.
        parameters: what can be set.
    """

    kind: str
    name: str
    summary: str
    plugin: str
    words: str
    parameters: tuple[Parameter, ...]

    def __str__(self) -> str:
        told = [self.words] if self.words else []
        told += [f"{one.place}{one.name}={one.default}  {one.description}" for one in self.parameters]
        told += [] if self.parameters or self.kind == "task" else ["no parameters"]
        lines = "\n".join(told).splitlines()
        return "\n".join([f"{self.kind} {self.name}: {self.summary}  ({self.plugin})", *(f"  {one}" for one in lines)])


class Described(tuple[About, ...]):
    """Everything that is called so, one entry a kind; shows itself as text and as a table."""

    __slots__ = ()

    def __str__(self) -> str:
        return "\n".join(map(str, self))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return "".join(map(_as_html, self))


def describe(name: str) -> Described:
    """What components of a name are, and what can be set of them; as ``polyfold plugins show`` prints it.

    Args:
        name: of a component, for example ``"csam+caso"``.

    Raises:
        PluginError: if nothing is called so, with the nearest names.
    """
    kinds = [kind for kind in KINDS if name in plugins.names(kind)]
    if not kinds:
        known = sorted({one for kind in KINDS for one in plugins.names(kind)})
        raise PluginError(f"no component is called {name!r}; {did_you_mean(name, known)}")
    return Described(about(kind, name) for kind in kinds)


def about(kind: str, name: str) -> About:
    """One component of a kind (plural), also where something that it needs is not installed."""
    found, field = plugins.catalog().components[kind][name][0], singular(kind)
    cls = None if kind == "tasks" else found.load(f"the {field} {name!r}")
    words = "" if cls is None else inspect.cleandoc(cls.__doc__ or "").split("\n\n")[0]
    return About(field, name, found.summary, found.plugin.label, words, tuple(_parameters(cls, field)))


def _parameters(cls: Any, field: str) -> Iterable[Parameter]:
    if not isinstance(cls, Configurable):
        return
    # What an experiment has none of is set where it is named, such as a camera in a simulator's table.
    place = f"--set {field}." if field in Experiment.model_fields else ""
    for name, one in cls.Config.model_fields.items():
        yield Parameter(name, _values(one), _default(one), one.description or "", place)


def _default(field: Any) -> str:
    if field.is_required():
        return "…"
    value = field.get_default(call_default_factory=True)
    return "" if value is None else json.dumps(value, default=_as_data)


def _as_data(value: Any) -> Any:
    return value.model_dump(mode="json", exclude_none=True) if isinstance(value, BaseModel) else str(value)


def _values(field: Any) -> str:
    """What a field may be, for example ``number above 0, at most 1``."""
    bounds = []
    for constraint in field.metadata:
        for attribute, words in (("gt", "above"), ("ge", "from"), ("lt", "below"), ("le", "to")):
            if (bound := getattr(constraint, attribute, None)) is not None:
                bounds.append(f"{words} {bound:g}" if isinstance(bound, int | float) else f"{words} {bound}")
    return " ".join([_type_in_words(field.annotation), *bounds])


_WORDS = {
    bool: "true or false",
    int: "whole number",
    float: "number",
    str: "text",
    type(None): "none",
    Path: "file",
    ComponentSpec: "component",
}


def _type_in_words(annotation: Any) -> str:
    if annotation in _WORDS:
        return _WORDS[annotation]
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return " or ".join(map(json.dumps, arguments))
    if origin in (Union, types.UnionType):
        return " or ".join(map(_type_in_words, arguments))
    if origin is Annotated:
        return _type_in_words(arguments[0])
    if origin is tuple and Ellipsis not in arguments:
        return f"list of {len(arguments)} of {_type_in_words(arguments[0])}"
    if origin in (tuple, list, frozenset):
        return f"list of {_type_in_words(arguments[0])}"
    return "table"


def _as_html(told: About) -> str:
    rows = "".join(
        f"<tr><td style='text-align:left'><code>{escape(one.place + one.name)}</code></td>"
        f"<td style='text-align:left'>{escape(one.values)}</td><td style='text-align:left'>{escape(one.default)}</td>"
        f"<td style='text-align:left'>{escape(one.description)}</td></tr>"
        for one in told.parameters
    )
    heads = "".join(f"<th style='text-align:left'>{head}</th>" for head in ("set", "values", "default", "what"))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>" if rows else ""
    return (
        f"<p><b>{escape(told.kind)} {escape(told.name)}</b>: {escape(told.summary)} "
        f"<small>({escape(told.plugin)})</small><br>{escape(told.words)}</p>{table}"
    )
