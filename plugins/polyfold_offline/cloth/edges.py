"""Edges by the names of their vertices."""

from __future__ import annotations

import re
from collections.abc import Iterable

CREASE = re.compile(r"fold(\d+)_(start|end)")
"""Names of the ends of creases."""

_EDGE_WORDS = {
    "bottom": ("hem", "bottom_left", "bottom_right", "leg_outer"),
    "top": ("shoulder", "top_left", "top_right", "waist"),
}


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


def partner(name: str, edge: str) -> str:
    """The vertex that mirrors ``name`` on the opposite edge, by name."""
    if edge in ("left", "right"):
        other = "right" if edge == "left" else "left"
        return f"{name[: -len(edge)]}{other}"
    for low, high in (("hem", "shoulder"), ("bottom", "top"), ("leg_outer", "waist"), ("hem", "waist")):
        a, b = (low, high) if edge == "bottom" else (high, low)
        if name.startswith(a):
            return b + name[len(a) :]
    return name
