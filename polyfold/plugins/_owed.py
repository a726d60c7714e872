"""What each kind of component owes: its methods, what they are handed and must return, and how that is looked at.

What is looked at is cheap. Classes that are looked for are imported only when there is something to look at.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

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
        signed: attribute of what it returns into which the host writes who made it; empty for none.
    """

    arguments: tuple[str, ...]
    returns: str
    wrong: Wrong
    calls_back: bool = False
    signed: str = ""


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


def _no_scene(returned: Any, handed: Sequence[Any]) -> str | None:
    from polyfold.types import Scene

    if not isinstance(returned, Scene):
        return _what(returned)
    if wrong := _no_strict_json(returned.text):
        return f"a Scene whose text {wrong},"
    shown = returned.shown
    if not isinstance(shown, tuple) or not shown or not all(isinstance(name, str) for name in shown):
        return f"a Scene whose shown is {shown!r}, no tuple of names such as ('polygon',),"
    if wrong := _no_mask(returned.mask, handed):
        return f"a Scene whose mask is {wrong.removesuffix(',')}, not bool and of the picture's shape (H, W),"
    shape = getattr(returned.contour, "shape", None)
    if shape is None or len(shape) != 2 or shape[1] != 2:
        return f"a Scene whose contour has {'no shape' if shape is None else f'shape {shape}'}, not (N, 2),"
    return None


def _no_strict_json(text: Any) -> str | None:
    if not isinstance(text, str):
        return f"is {_what(text)} and no string"
    try:
        told = json.loads(text, parse_constant=_refuse_constant)
    except _ConstantError as error:
        return f"holds {error}, which JSON does not have"
    except (ValueError, RecursionError):
        return f"is no JSON ({text[:60]!r})"
    return None if isinstance(told, dict) else f"is JSON and no object ({text[:60]!r})"


class _ConstantError(Exception):
    """NaN or an infinity, which Python reads and writes although JSON has none."""


def _refuse_constant(name: str) -> None:
    raise _ConstantError(name)


def _no_garment(returned: Any, handed: Sequence[Any]) -> str | None:
    import numpy as np

    from polyfold.garments import Garment

    if not isinstance(returned, Garment):
        return _what(returned)
    vertices, triangles = np.asarray(returned.mesh.vertices), np.asarray(returned.mesh.triangles)
    if vertices.ndim != 2 or vertices.shape[1] != 2 or not len(vertices):
        return f"a Garment whose mesh has vertices of shape {vertices.shape}, not (N, 2),"
    if not np.isfinite(vertices).all():
        off = int((~np.isfinite(vertices)).any(axis=1).sum())
        return f"a Garment whose mesh has {off} of {len(vertices)} vertices that are not finite (NaN or infinite),"
    if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
        return f"a Garment whose mesh has triangles of shape {triangles.shape}, not (T, 3),"
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        return f"a Garment whose mesh has triangles of vertices that there are not (it has {len(vertices)}),"
    strange = [name for name, vertex in returned.keypoints.items() if not 0 <= vertex < len(vertices)]
    return f"a Garment whose keypoint {strange[0]!r} is no vertex of its mesh," if strange else None


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
            ("observation", "mask", "template", "previous", "fold_line"),
            "a Scene: its text a strict JSON object, as json.dumps({...}, allow_nan=False) writes it",
            _no_scene,
            signed="grounding",
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
        "generate": Owed(("seed", "edge_length"), "a Garment with a finite mesh [m]", _no_garment),
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
