"""The cloth as the model's text describes it: where vertices lie now, and where they lay before the folds."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from polyfold_offline.cloth.edges import CREASE, edge_vertices
from polyfold_offline.cloth.garment import NotUnderstoodError

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel

Point = NDArray[np.float64]

_SEEN = 0.04
"""A corner of the outline this near to where a vertex lay, as a share of the outline's extent, is that vertex."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Vertices in an image, or corners of an outline without names.

    Attributes:
        kind: garment kind, empty if the text does not say.
        size: (width, height) [px].
        points: name -> where it lies now [px], shape (2,); corners of an outline are called ``point 1`` and so on.
        flat: name -> where it lay before the first fold [px], shape (2,).
        folds: how many folds the text shows.
        px_per_cm: pixels to a centimetre; 0 if not told.
    """

    kind: str
    size: tuple[int, int]
    points: Mapping[str, Point]
    flat: Mapping[str, Point] = field(default_factory=dict)
    folds: int = 0
    px_per_cm: float = 0.0

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
        folds = max((int(found[1]) for name in points if (found := CREASE.fullmatch(name))), default=int(nameless))
        named = {} if nameless else {name: point for name, point in points.items() if not CREASE.fullmatch(name)}
        scale = image.get("px_per_cm")
        px_per_cm = float(scale) if isinstance(scale, (int, float)) else 0.0
        return cls(str(content.get("garment", "")), size, points, named | before, folds, px_per_cm)

    @classmethod
    def of_model(cls, model: FoldedModel, size: tuple[int, int], pixels_per_metre: float | None = None) -> Shape:
        """The shape of a model in an image.

        Args:
            model: the cloth.
            size: (width, height) of the image [px].
            pixels_per_metre: its scale, if known.
        """
        return cls.from_text(json.loads(model.to_text(size, pixels_per_metre)))

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
