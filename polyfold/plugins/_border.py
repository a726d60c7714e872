"""The border between the host and components: how they may be called, and whether what they return is what they owe.

Here, and here alone, a component's fault gets the component's name. What is looked at is cheap; what is dear (whether
it is deterministic, whether it changes what is not locked here) is for :mod:`polyfold.testing`.
"""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass
from functools import update_wrapper
from typing import Any

from polyfold.errors import ActionError, PluginError, PolyfoldError
from polyfold.plugins._owed import ATTRIBUTES, METHODS, Owed

PASSED_ON = (PolyfoldError, OSError, MemoryError)
"""Errors that say by themselves what to do."""
CHOOSING = ("act", "plan")
"""Methods that choose picks and places: one that can't be is theirs, where other components are told of it."""
LENT = ("segmenters", "groundings", "planners", "policies", "agents", "metrics")
"""Kinds whose methods can't write into the arrays that they are handed: others work on these after them."""


def guarded(component: Any, kind: str, owner: str) -> Any:
    """A component whose faults bear its name.

    Args:
        component: what a plugin made.
        kind: one of :data:`polyfold.plugins.hookspecs.KINDS`.
        owner: the component and its plugin in words.

    Raises:
        PluginError: if it lacks something that its kind must have, or a method can't be called as it will be.
    """
    for attribute, meaning in ATTRIBUTES.get(kind, {}).items():
        if not hasattr(component, attribute):
            raise PluginError(f"{owner} has no {attribute!r}, {meaning}; add it to its class")
    for name, owed in METHODS.get(kind, {}).items():
        method = getattr(component, name, None)
        if not callable(method):
            raise PluginError(f"{owner} has no method {name}({', '.join(owed.arguments)}); its class must have one")
        _refuse_uncallable(method, name, owed, owner)
        try:
            setattr(component, name, _Guard(method, name, owed, owner, lends=kind in LENT))
        except AttributeError:  # slots, or frozen: it goes without
            return component
    return component


def constructed(cls: Any, arguments: Sequence[Any], components: Mapping[str, Any], owner: str) -> Any:
    """A component's class with what the host gives it; its faults bear the component's name.

    Args:
        cls: the class.
        arguments: its configuration, or nothing.
        components: those that an agent is made of.
        owner: the component and its plugin in words.

    Raises:
        PluginError: if it can't be made of these, or fails.
    """
    _refuse_unmakeable(cls, arguments, components, owner)
    try:
        return cls(*arguments, **components)
    except PASSED_ON:
        raise
    except (Exception, SystemExit) as error:
        raise PluginError(f"{owner} can't be constructed: {_told(error)}") from error


class _Guard:
    """A method that is called as ever."""

    def __init__(self, method: Callable[..., Any], name: str, owed: Owed, owner: str, lends: bool) -> None:
        self._method, self._name, self._owed, self._owner, self._lends = method, name, owed, owner, lends
        update_wrapper(self, method)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        handed = [*arguments, *named.values()] if self._lends else []
        try:
            with _read_only(handed):
                returned = self._method(*arguments, **named)
        except ActionError as error:
            if self._name not in CHOOSING:
                raise
            raise ActionError(f"{self._owner} chose what can't be done: {error}") from error
        except PASSED_ON:
            raise
        except Exception as error:
            if self._owed.calls_back:
                raise
            if handed and _is_refused_write(error):
                raise PluginError(
                    f"{self._owner} writes in {self._name} into an array that is read-only, as all are that it is "
                    f"handed ({_place(error)}); copy it first: array.copy()"
                ) from error
            raise PluginError(f"{self._owner} failed in {self._name}: {_told(error)}") from error
        if wrong := self._owed.wrong(returned, arguments):
            raise PluginError(f"{self._owner} returned {wrong} from {self._name}; it must return {self._owed.returns}")
        if self._owed.signed:
            object.__setattr__(returned, self._owed.signed, self._owner)
        return returned


@contextmanager
def _read_only(handed: Sequence[Any]) -> Iterator[None]:
    """Let nobody write into arrays meanwhile, nor into those of pictures, scenes and outcomes; nothing is copied."""
    locked = [array for value in handed for array in _arrays(value) if array.flags.writeable]
    for array in locked:
        array.flags.writeable = False
    try:
        yield
    finally:
        # A view can't be unlocked before what it is a view of.
        for array in sorted(locked, key=lambda array: array.base is not None):
            with suppress(ValueError):
                array.flags.writeable = True


def _arrays(value: Any) -> Iterator[Any]:
    import numpy as np

    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _arrays(one)
    elif is_dataclass(value) and type(value).__module__.startswith("polyfold.types"):
        for field in fields(value):
            yield from _arrays(getattr(value, field.name))


def _is_refused_write(error: Exception) -> bool:
    """Whether numpy, or OpenCV, refused to write into an array."""
    return "read-only" in str(error) or "readonly" in str(error)


def _refuse_uncallable(method: Callable[..., Any], name: str, owed: Owed, owner: str) -> None:
    signature = _signature(method)
    if signature is None:
        return
    asked = f"{name}({', '.join(owed.arguments)})"
    try:
        signature.bind(*owed.arguments)
    except TypeError:
        raise PluginError(
            f"{owner} has {name}{signature}, which is called as {asked}; give it these arguments"
        ) from None
    # They are handed by place: one that is called like another of them would be given that other's value.
    taken = list(signature.parameters)[: len(owed.arguments)]
    if any(taken[at] in owed.arguments and taken[at] != owed.arguments[at] for at in range(len(taken))):
        raise PluginError(f"{owner} has {name}{signature}, whose order is {asked}; give its arguments in that order")


def _refuse_unmakeable(cls: Any, arguments: Sequence[Any], components: Mapping[str, Any], owner: str) -> None:
    signature = _signature(cls)
    if signature is None:
        return
    try:
        signature.bind(*arguments, **components)
    except TypeError:
        given = ["an instance of its Config"] if arguments else []
        given += [f"{name}=…" for name in components]
        takes = f"is given {', '.join(given)}" if given else "is given nothing, as it has no Config"
        raise PluginError(
            f"{owner} can't be constructed: its __init__{signature} {takes}; take that alone, and make each further "
            "argument a field of a nested pydantic model Config, or give it a default"
        ) from None


def _signature(called: Callable[..., Any]) -> inspect.Signature | None:
    """How something is called, without ``self``; None where it is not written in Python."""
    try:
        return inspect.signature(called)
    except (TypeError, ValueError):
        return None


def _told(error: BaseException) -> str:
    """An unexpected error in one line, with the place it comes from."""
    said = " ".join(str(error).split())
    return f"{type(error).__name__}: {said} ({_place(error)}); a fault of that plugin"


def _place(error: BaseException) -> str:
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{place.filename}:{place.lineno}, in {place.name}"
