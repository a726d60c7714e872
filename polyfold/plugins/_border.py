"""The border between the host and components: how they may be called, and whether what they return is what they owe.

Here, and here alone, a component's fault gets the component's name. What is looked at is cheap; what is dear (whether
it changes what it is handed, whether it is deterministic) is for :mod:`polyfold.testing`.
"""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import update_wrapper
from importlib import import_module
from typing import Any

from polyfold.errors import ActionError, PluginError, PolyfoldError

PASSED_ON = (PolyfoldError, OSError, MemoryError)
"""Errors that say by themselves what to do."""
CHOOSING = ("act", "plan")
"""Methods that choose picks and places: one that can't be is theirs, where other components are told of it."""

Wrong = Callable[[Any, Sequence[Any]], str | None]
"""Says of what a method returned, and of what it was handed, what is wrong; None if nothing is."""


@dataclass(frozen=True)
class Owed:
    """What a method must do.

    Attributes:
        arguments: names of what it is handed.
        returns: what it must return, in words.
        wrong: says what is wrong with what it returned.
        calls_back: whether it calls functions that it is handed, whose errors are not its own.
    """

    arguments: tuple[str, ...]
    returns: str
    wrong: Wrong
    calls_back: bool = False


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
            setattr(component, name, _Guard(method, name, owed, owner))
        except AttributeError:  # slots, or frozen: it goes without
            return component
    return component


def faultless(make: Callable[[], Any], owner: str) -> Any:
    """What ``make`` makes of a component's class; its faults bear the component's name."""
    try:
        return make()
    except PASSED_ON:
        raise
    except (Exception, SystemExit) as error:
        raise PluginError(f"{owner} can't be constructed: {_told(error)}") from error


class _Guard:
    """A method that is called as ever."""

    def __init__(self, method: Callable[..., Any], name: str, owed: Owed, owner: str) -> None:
        self._method, self._name, self._owed, self._owner = method, name, owed, owner
        update_wrapper(self, method)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        try:
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
            raise PluginError(f"{self._owner} failed in {self._name}: {_told(error)}") from error
        if wrong := self._owed.wrong(returned, arguments):
            raise PluginError(f"{self._owner} returned {wrong} from {self._name}; it must return {self._owed.returns}")
        return returned


def _refuse_uncallable(method: Callable[..., Any], name: str, owed: Owed, owner: str) -> None:
    try:
        signature = inspect.signature(method)
    except (TypeError, ValueError):  # not written in Python
        return
    try:
        signature.bind(*owed.arguments)
    except TypeError:
        raise PluginError(
            f"{owner} has {name}{signature}, which is called as {name}({', '.join(owed.arguments)}); "
            "give it these arguments"
        ) from None


def _told(error: BaseException) -> str:
    """An unexpected error in one line, with the place it comes from."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    said = " ".join(str(error).split())
    return f"{type(error).__name__}: {said} ({place.filename}:{place.lineno}, in {place.name}); a fault of that plugin"


def _is(home: str, *names: str, also: tuple[Any, ...] = ()) -> Wrong:
    """An instance of one of these classes of a module, imported when there is something to look at."""

    def wrong(returned: Any, handed: Sequence[Any]) -> str | None:
        module = import_module(home)
        fits = isinstance(returned, tuple(getattr(module, name) for name in names))
        fits |= any(returned is one for one in also)
        return None if fits else _what(returned)

    return wrong


def _are(home: str, name: str) -> Wrong:
    """A sequence of instances of a class."""
    one = _is(home, name)

    def wrong(returned: Any, handed: Sequence[Any]) -> str | None:
        if isinstance(returned, str) or not isinstance(returned, Sequence):
            return _what(returned)
        return next((f"{what} among them" for item in returned if (what := one(item, handed))), None)

    return wrong


def _what(returned: Any) -> str:
    if returned is None:
        return "None"
    kind = type(returned).__name__
    return f"{'an' if kind[0] in 'aeiouAEIOU' else 'a'} {kind}"


def _anything(returned: Any, handed: Sequence[Any]) -> None:
    return None


def _no_mask(returned: Any, handed: Sequence[Any]) -> str | None:
    import numpy as np

    if not isinstance(returned, np.ndarray):
        return _what(returned)
    wanted = handed[0].rgb.shape[:2] if handed and hasattr(handed[0], "rgb") else returned.shape
    if returned.dtype != bool or returned.shape != wanted:
        return f"an array of {returned.dtype}, shape {returned.shape},"
    return None


def _no_number(returned: Any, handed: Sequence[Any]) -> str | None:
    import numbers

    return None if isinstance(returned, numbers.Real) else _what(returned)


_SEEN = Owed((), "an Observation", _is("polyfold.types", "Observation"))

METHODS: Mapping[str, Mapping[str, Owed]] = {
    "simulators": {
        "reset": Owed(("garment", "seed"), _SEEN.returns, _SEEN.wrong),
        "observe": _SEEN,
        "execute": Owed(("action",), _SEEN.returns, _SEEN.wrong),
        "state": Owed((), "a SimState", _is("polyfold.types", "SimState")),
        "restore": Owed(("state",), "nothing", _anything),
        "close": Owed((), "nothing", _anything),
    },
    "segmenters": {"segment": Owed(("observation",), "a mask: bool, of the picture's shape (H, W)", _no_mask)},
    "groundings": {
        "ground": Owed(
            ("observation", "mask", "template", "previous", "fold_line"), "a Scene", _is("polyfold.types", "Scene")
        )
    },
    "planners": {
        "subgoals": Owed(
            ("instruction", "template", "conversation"), "a list of Subgoals", _are("polyfold.types", "Subgoal")
        ),
        "plan": Owed(
            ("subgoal", "scene", "conversation"),
            "a FoldLine, an Action, an earlier Subgoal, or None when nothing is left to do",
            _is("polyfold", "FoldLine", "Action", "Subgoal", also=(None,)),
        ),
    },
    "policies": {
        "act": Owed(("fold_line", "scene", "rng"), "an Action: picks and places [px]", _is("polyfold.types", "Action"))
    },
    "llms": {"complete": Owed(("messages", "params"), "a Reply", _is("polyfold.types", "Reply"))},
    "agents": {
        "begin": Owed(
            ("goal", "observation"), "a list of Subgoals, empty if it has none", _are("polyfold.types", "Subgoal")
        ),
        "decide": Owed(
            ("observation",), "a Decision, or None when it is done", _is("polyfold.types", "Decision", also=(None,))
        ),
    },
    "garments": {
        "template": Owed((), "a Template", _is("polyfold.polygon", "Template")),
        "generate": Owed(("seed", "edge_length"), "a Garment", _is("polyfold.garments", "Garment")),
    },
    "fabrics": {"fabric": Owed((), "a Fabric", _is("polyfold.garments", "Fabric"))},
    "metrics": {"score": Owed(("result", "references"), "a number", _no_number)},
    "cameras": {
        "connect": Owed((), "nothing", _anything),
        "close": Owed((), "nothing", _anything),
        "get_rgbd": Owed(("frames",), "an RgbdFrame", _is("polyfold.plugins.hardware", "RgbdFrame")),
    },
    "robots": {
        "connect": Owed((), "nothing", _anything),
        "close": Owed((), "nothing", _anything),
        "plan": Owed(
            ("picks", "places"), "a plan, or Infeasible", _is("polyfold.plugins.hardware", "RobotPlan", "Infeasible")
        ),
        "execute": Owed(("plan", "watch"), "nothing", _anything, calls_back=True),
        "limits": Owed(("arm",), "an ArmLimits", _is("polyfold.plugins.hardware", "ArmLimits")),
        "tcp_pose": Owed(("arm",), "a pose, shape (4, 4)", _anything),
        "joint_state": Owed(("arm",), "angles, shape (N,)", _anything),
        "move_linear": Owed(("arm", "pose", "speed"), "nothing", _anything),
        "gripper": Owed(("arm", "closed"), "how wide the hand is [m]", _no_number),
        "park": Owed((), "nothing", _anything),
        "stop": Owed((), "nothing", _anything),
    },
}
"""What each kind of component owes, method by method.

As the protocols of :mod:`polyfold.plugins.interfaces` have it, which a test compares: importing these would load numpy
where components are only made.
"""

ATTRIBUTES: Mapping[str, Mapping[str, str]] = {
    "agents": {"requires": "what it is handed at the start, such as frozenset({'instruction'})"},
    "garments": {"kind": "what it is called"},
    "metrics": {
        "unit": "the unit of its values, empty if they have none",
        "higher_is_better": "which way is good",
    },
    "criteria": {"thresholds": "the bounds that must all hold"},
}
"""What each kind of component must have beside methods, and what that is."""
