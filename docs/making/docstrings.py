"""Docstrings as Sphinx can show them."""

from __future__ import annotations

import re
from typing import Any

_SEVERAL = re.compile(r"( +)(\w+(?:, \w+)+): (.*)")


def prepare(_app: Any, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    """Write ``picks, places: pixels`` as two entries, each with the words that follow."""
    told: list[str] = []
    within = False
    while lines:
        line = lines.pop(0)
        within = line.rstrip() in ("Attributes:", "Args:") or (within and (not line or line.startswith(" ")))
        several = _SEVERAL.fullmatch(line) if within else None
        if several is None:
            told.append(line)
            continue
        indent, names, words = several.groups()
        more = []
        while lines and lines[0].startswith(indent + " "):
            more.append(lines.pop(0))
        for name in names.split(", "):
            told += [f"{indent}{name}: {words}", *more]
    lines[:] = told
