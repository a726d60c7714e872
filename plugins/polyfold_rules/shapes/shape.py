"""The cloth as the model's text describes it: where vertices lie now, and where they lay before the folds."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold_rules.shapes.parts import NotUnderstoodError

Point = NDArray[np.float64]

_CREASE = re.compile(r"fold(\d+)_(start|end)")
_SEEN = 0.04
"""A corner of the outline this near to where a vertex lay, as a share of the outline's extent, is that vertex."""

_EDGE_WORDS = {
    "bottom": ("hem", "bottom_left", "bottom_right", "leg_outer"),
    "top": ("shoulder", "top_left", "top_right", "waist"),
}


@dataclass(frozen=True, eq=False)
class Shape:
    """Vertices in an image, or corners of an outline without names.

    Attributes:
        kind: garment kind, empty if the text does not say.
        size: (width, height) [px].
        points: name -> where it lies now [px], shape (2,); corners of an outline are called ``point 1`` and so on.
        flat: name -> where it lay before the first fold [px], shape (2,).
        folds: how many folds the text shows.
    """

    kind: str
    size: tuple[int, int]
    points: Mapping[str, Point]
    flat: Mapping[str, Point] = field(default_factory=dict)
    folds: int = 0

    @classmethod
    def from_text(cls, content: Mapping[str, Any]) -> Shape:
        """Read a decoded model text; vertices without usable coordinates are passed over.

        Raises:
            NotUnderstoodError: if it shows nothing that a fold could be read from; it says what is missing.
        """
        image = content.get("image")
        image = image if isinstance(image, Mapping) else {}
        size = (int(image.get("width", 400)), int(image.get("height", 400)))
        points = _places(content.get("vertices", content.get("keypoints")))
        before = _places(content.get("flat"))
        nameless = isinstance(content.get("keypoints"), list)
        if len(points) < 3 or (nameless and len(before) < 3):
            lacks = "points without names, and not where they lay when flat" if nameless and points else "no vertices"
            raise NotUnderstoodError(
                f"the cloth is described by {lacks}; choose a grounding whose text holds them, such as polygon"
            )
        folds = max((int(found[1]) for name in points if (found := _CREASE.fullmatch(name))), default=int(nameless))
        named = {} if nameless else {name: point for name, point in points.items() if not _CREASE.fullmatch(name)}
        return cls(str(content.get("garment", "")), size, points, named | before, folds)

    @property
    def nameless(self) -> bool:
        """Whether the points that are seen now have no names."""
        return "point 1" in self.points

    @property
    def named(self) -> bool:
        """Whether the flat garment's vertices have names that tell of edges."""
        return bool(edge_vertices(self.flat, "left")) and bool(edge_vertices(self.flat, "bottom"))

    def now(self, name: str) -> Point | None:
        """Where a vertex of the flat garment lies now [px], shape (2,); None where that is not seen."""
        if not self.nameless:
            return self.points.get(name)
        outline = self.outline()
        far = np.hypot(*(outline - self.flat[name]).T)
        return outline[int(far.argmin())] if far.min() < _SEEN * np.ptp(outline, axis=0).max() else None

    def outline(self) -> NDArray[np.float64]:
        """All positions now [px], shape (N, 2)."""
        return np.array(list(self.points.values()))


def _places(entries: Any) -> dict[str, Point]:
    """Name -> where it lies [px]; entries are ``[x, y]`` or ``{"at": [x, y], ...}``, and others are passed over."""
    if isinstance(entries, list):
        entries = {f"point {number}": entry for number, entry in enumerate(entries, 1)}
    found = {}
    for name, entry in entries.items() if isinstance(entries, Mapping) else ():
        at = entry.get("at") if isinstance(entry, Mapping) else entry
        if isinstance(at, (list, tuple)) and len(at) == 2 and all(isinstance(value, (int, float)) for value in at):
            found[str(name)] = np.array(at, float)
    return found


def edge_vertices(points: Mapping[str, Point], edge: str) -> list[str]:
    """Names of the vertices that bound an edge, in a fixed order; sleeves and inner legs do not count.

    Args:
        points: name -> position [px], shape (2,).
        edge: ``left``, ``right``, ``top`` or ``bottom``.
    """
    names = [name for name in points if not _CREASE.fullmatch(name)]
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
