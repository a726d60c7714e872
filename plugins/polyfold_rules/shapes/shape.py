"""The cloth as the model's text describes it: where vertices lie now, and where they lay before the folds."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import mirror

Point = NDArray[np.float64]

_CREASE = re.compile(r"fold(\d+)_(start|end)")
_EDGE_WORDS = {
    "bottom": ("hem", "bottom_left", "bottom_right", "leg_outer"),
    "top": ("shoulder", "top_left", "top_right", "waist"),
}


@dataclass(frozen=True, eq=False)
class Shape:
    """Vertices in an image.

    Attributes:
        kind: garment kind, empty if the text does not say.
        size: (width, height) [px].
        points: name -> where it lies now [px], shape (2,).
        flat: name -> where it lay on the flat garment [px], shape (2,), for the vertices of which that is certain.
        folds: how many folds the text shows.
    """

    kind: str
    size: tuple[int, int]
    points: Mapping[str, Point]
    flat: Mapping[str, Point] = field(default_factory=dict)
    folds: int = 0

    @classmethod
    def from_text(cls, content: Mapping[str, Any]) -> Shape:
        """Read a decoded model text; vertices without usable coordinates are passed over."""
        image = content.get("image")
        if not isinstance(image, Mapping):
            image = {}
        size = (int(image.get("width", 400)), int(image.get("height", 400)))
        entries = _entries(content)
        points = {name: np.array([float(e["x"]), float(e["y"])]) for name, e in entries.items()}
        layers = {name: sorted(int(i) for i in e.get("layers", [0])) or [0] for name, e in entries.items()}
        folds = max((int(found[1]) for name in points if (found := _CREASE.fullmatch(name))), default=0)
        flat = _unfolded(points, layers, folds)
        return cls(str(content.get("garment", "")), size, points, flat, folds)

    @property
    def named(self) -> bool:
        """Whether the vertices have meaningful names."""
        return bool(edge_vertices(self.points, "left")) and bool(edge_vertices(self.points, "bottom"))

    def outline(self) -> NDArray[np.float64]:
        """All positions now [px], shape (N, 2)."""
        return np.array(list(self.points.values()))


def _entries(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    raw = content.get("vertices", content.get("keypoints", {}))
    if isinstance(raw, list):
        raw = {str(e.get("name", f"p{i}")) if isinstance(e, Mapping) else f"p{i}": e for i, e in enumerate(raw)}
    found = {}
    for name, entry in raw.items():
        if isinstance(entry, (list, tuple)) and len(entry) == 2:
            entry = {"x": entry[0], "y": entry[1]}
        if isinstance(entry, Mapping) and all(isinstance(entry.get(axis), (int, float)) for axis in "xy"):
            found[str(name)] = entry
    return found


def _unfolded(points: Mapping[str, Point], layers: Mapping[str, list[int]], folds: int) -> dict[str, Point]:
    """Undo the folds, last one first.

    A fold turns layer l into S - l, where S is one number for the whole fold: the sum of the lowest and the highest
    layer that meet at its crease. Layers between those that meet there could have been lifted whole; that is rare, so
    they are taken to have stayed.
    """
    flat = {name: point for name, point in points.items() if not _CREASE.fullmatch(name)}
    level = {name: layers[name][0] for name in flat}
    creases = {n: points[n] for n in points if _CREASE.fullmatch(n)}
    crease_layers = {n: list(layers[n]) for n in creases}
    for number in range(folds, 0, -1):
        ends = [f"fold{number}_start", f"fold{number}_end"]
        if not all(end in creases for end in ends):
            return {name: point for name, point in flat.items() if level[name] == 0}
        meeting = sorted({layer for end in ends for layer in crease_layers[end]})
        start, end = creases[ends[0]], creases[ends[1]]
        if len(meeting) < 2 or np.hypot(*(end - start)) < 1.0:
            return {name: point for name, point in flat.items() if level[name] == 0}
        total = meeting[0] + meeting[-1]
        # Flaps of earlier folds may touch the crease's end without belonging to it: they lack a counterpart.
        paired = {layer for end in ends for layer in crease_layers[end] if total - layer in crease_layers[end]}
        moved = min((layer for layer in paired if 2 * layer > total), default=meeting[-1])
        for name in list(flat):
            if level[name] >= moved:
                flat[name], level[name] = mirror(flat[name], start, end), total - level[name]
        for name in (f"fold{k}_{which}" for k in range(1, number) for which in ("start", "end")):
            if name in creases:
                back = [total - layer for layer in crease_layers[name] if layer >= moved]
                if back and all(layer >= moved for layer in crease_layers[name]):
                    creases[name] = mirror(creases[name], start, end)
                crease_layers[name] = sorted({layer for layer in crease_layers[name] if layer < moved} | set(back))
    return flat


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
