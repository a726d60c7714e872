"""What may be registered under which name, and what is said of a name that nobody registered."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches

from polyfold.errors import PluginError
from polyfold.plugins._owed import METHODS
from polyfold.plugins.hookspecs import singular

_NAME = re.compile(r"[a-z0-9][a-z0-9+_-]{0,49}")


def refuse_name(kind: str, name: object) -> None:
    """Raises PluginError for a name that no component may have.

    One name is taken: it stands for whichever fabric a kind of garment is usually made of.
    """
    from polyfold.config import USUAL

    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise PluginError(
            f"the component name {name!r} is not allowed; use lower-case letters, digits, '+', '-' and '_', 50 at "
            "most, and begin with a letter or a digit"
        )
    if (kind, name) == ("fabrics", USUAL):
        raise PluginError(f"the name {name!r} stands for the usual fabric of each kind of garment; choose another")


def refuse_target(kind: str, name: str, target: object) -> None:
    """Raises PluginError for what is neither a class nor a text that says where one is; the text alone is looked at."""
    if kind == "tasks":
        if not isinstance(target, str):
            raise PluginError(f"the suite of tasks {name!r} is a file; give its path, not {_described(target)}")
        return
    if isinstance(target, type) or (isinstance(target, str) and _is_place(target)):
        return
    if isinstance(target, str):
        raise PluginError(f"the target {target!r} of {name!r} must read 'package.module:Class'")
    wanted = ", ".join(f"{method}({', '.join(owed.arguments)})" for method, owed in METHODS.get(kind, {}).items())
    kindly = f" with {wanted}" if wanted else ""
    what = _described(target)
    if target is not None and not inspect.isroutine(target):
        what += f"; give {type(target).__name__} itself, of which one is made for each run"
        raise PluginError(f"the {singular(kind)} {name!r} is to be a class{kindly}, not {what}")
    raise PluginError(
        f"the {singular(kind)} {name!r} is to be a class{kindly}, not {what}; write such a class, give it"
    )


def _is_place(target: str) -> bool:
    module, _, attribute = target.partition(":")
    return bool(module and attribute)


def _described(target: object) -> str:
    if target is None:
        return "None"
    if inspect.isroutine(target):
        return f"the function {getattr(target, '__name__', '')!r}"
    if isinstance(target, type):
        return f"the class {target.__name__}"
    return f"an instance of {type(target).__name__}"


def which_garment(name: str, also: Mapping[str, Sequence[str]]) -> str:
    """The kind that people call so, or all kinds with what else they are called; few names are near by chance.

    Args:
        name: that nobody registered.
        also: kind -> what else it is called.

    Returns:
        A phrase for the end of a message, such as ``did you mean 'tshirt'?``.
    """
    one = name.lower().removesuffix("s")
    called = {kind: (kind.removesuffix("s"), *(other.removesuffix("s") for other in also[kind])) for kind in also}
    # A kind's own name before what else another is called.
    for names in ({kind: known[:1] for kind, known in called.items()}, called):
        for kind, known_as in names.items():
            if one in known_as:
                return f"did you mean {kind!r}?"
    if near := get_close_matches(name.lower(), list(also), n=1, cutoff=0.8):
        return f"did you mean {near[0]!r}?"
    listed = (f"{kind} ({', '.join(names)})" if names else kind for kind, names in also.items())
    return f"there are {', '.join(listed)}"
