"""How values with arrays inside print: a line that names every field, and of what is large only its kind and size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

LONG = 60
"""Characters of a field that is printed as it is."""


def brief(self: Any) -> str:
    """A dataclass instance in one line, for ``__repr__ = brief`` with ``@dataclass(repr=False)``."""
    parts = [f"{field.name}={_short(getattr(self, field.name))}" for field in fields(self) if field.repr]
    return f"{type(self).__qualname__}({', '.join(parts)})"


def _short(value: Any) -> str:
    shape, dtype = getattr(value, "shape", None), getattr(value, "dtype", None)
    if shape and dtype is not None:
        return f"<{dtype}, shape {shape}>"
    if is_dataclass(value) and type(value).__repr__ is brief:
        return f"<{type(value).__qualname__}>"
    if isinstance(value, str):
        return repr(value if len(value) <= LONG else f"{value[: LONG - 1]}…")
    if isinstance(value, (tuple, list)) and any(is_dataclass(part) or hasattr(part, "shape") for part in value):
        return f"<{len(value)} × {type(value[0]).__qualname__}>"
    text = _name(value) if callable(value) else repr(value)
    if len(text) <= LONG:
        return text
    return f"<{type(value).__qualname__}{f' of {len(value)}' if isinstance(value, (Mapping, tuple, list)) else ''}>"


def _name(value: Any) -> str:
    return f"<{getattr(value, '__qualname__', type(value).__qualname__)}>"
