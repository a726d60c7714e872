"""Edges by the names of their vertices."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable

CREASE = re.compile(r"fold(\d+)_(start|end)")
"""Names of the ends of creases."""

_EDGE_WORDS = {
    "bottom": ("hem", "bottom_left", "bottom_right", "leg_outer"),
    "top": ("shoulder", "strap", "top_left", "top_right", "waist"),
}
_PARTNERS = (
    ("hem", "shoulder"), ("bottom", "top"), ("leg_outer", "waist"), ("hem", "waist"), ("hem", "strap_outer"),
)  # fmt: skip
"""Beginnings of the names of vertices below and above each other."""


def edge_vertices(points: Iterable[str], edge: str) -> list[str]:
    """Names of the vertices that bound an edge, in a fixed order; sleeves and inner legs do not count.

    Args:
        points: names of vertices.
        edge: ``left``, ``right``, ``top`` or ``bottom``.
    """
    names = [name for name in points if not CREASE.fullmatch(name)]
    if edge in ("left", "right"):
        return [n for n in names if n.endswith(f"_{edge}") and not n.startswith("sleeve")]
    ends = _EDGE_WORDS[edge]
    return [name for name in names if name.startswith(ends)]


def partner(name: str, edge: str, points: Container[str]) -> str | None:
    """Which of the named points mirrors ``name`` on the opposite edge, by name; None where none does."""
    if edge in ("left", "right"):
        other = "right" if edge == "left" else "left"
        found = f"{name[: -len(edge)]}{other}"
        return found if found != name and found in points else None
    for low, high in _PARTNERS:
        a, b = (low, high) if edge == "bottom" else (high, low)
        if name.startswith(a) and (found := b + name[len(a) :]) in points:
            return found
    return None
