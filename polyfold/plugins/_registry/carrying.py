"""Classes of a notebook or a script on their way to this machine's own worker processes, with their source."""

from __future__ import annotations

import inspect
from typing import Any

SOURCE = "__source_text__"
"""Attribute of a class that was carried: what ``inspect`` finds no more where it has come to."""


def portable(target: type | str) -> str | bytes | None:
    """Where another process finds a class; the class itself, packed, if it is of a notebook, a script or a function."""
    if isinstance(target, str):
        return target
    if target.__module__ == "__main__" or "<locals>" in target.__qualname__:
        return packed(target)
    return f"{target.__module__}:{target.__qualname__}"


def packed(cls: type) -> bytes | None:
    """The class by value, with what it uses of its notebook or script; None if that can't be."""
    import cloudpickle

    try:
        source = inspect.getsource(cls)
    except (OSError, TypeError):
        source = None
    try:
        return cloudpickle.dumps((cls, source))
    except Exception:  # whatever the class holds on to: a lock, a file, a simulator
        return None


def unpacked(content: bytes) -> Any:
    """The class. For what :func:`packed` made in a process of the same user, and nothing else."""
    import cloudpickle

    cls, source = cloudpickle.loads(content)
    setattr(cls, SOURCE, source)
    return cls
