"""The garment that a question is about."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from polyfold_offline.cloth.edges import edge_vertices
from polyfold_offline.cloth.folds import CORNERS


class NotUnderstoodError(Exception):
    """What is asked for can't be turned into folds; the message is the reason, in words for the person."""


@dataclass(frozen=True)
class Garment:
    """The garment on the table.

    Attributes:
        kind: its kind, such as ``tshirt``.
        family: ``square``, ``rectangle``, ``tshirt``, ``pants`` or ``other``: which parts and folds it has.
        parts: further names of its parts -> the edge, ``left right top bottom``, that they lie on.
        size_cm: width and height when flat [cm], if told.
    """

    kind: str
    family: str
    parts: Mapping[str, str] = field(default_factory=dict)
    size_cm: tuple[float, float] | None = None

    @classmethod
    def from_text(cls, content: Mapping[str, Any]) -> Garment:
        """Read a decoded template or model text."""
        told = content.get("vertices", content.get("keypoints"))
        names = told if isinstance(told, Mapping) else content.get("flat", ())
        kind = str(content.get("garment", ""))
        return cls(kind, _family(kind, names), _edges(content), _size(content.get("size_cm")))

    @property
    def plain(self) -> bool:
        """Whether it is a cloth with four corners."""
        return self.family in ("square", "rectangle")

    @property
    def said_as(self) -> str:
        """The kind whose words for edges are used: its own, or for kinds that are not known the family's."""
        return self.kind if self.kind in ("square", "rectangle", "tshirt", "pants") else self.family

    @property
    def spoken(self) -> str:
        """The kind in words."""
        known = {
            "tshirt": "t-shirt",
            "pants": "pair of pants",
            "square": "square cloth",
            "rectangle": "rectangle cloth",
        }
        return known.get(self.kind, self.kind.replace("_", " "))


def _size(told: Any) -> tuple[float, float] | None:
    match told:
        case [int() | float() as width, int() | float() as height]:
            return float(width), float(height)
    return None


def _family(kind: str, names: Iterable[str]) -> str:
    """Tell the family from the vertices' names."""
    names = set(names)
    if any("sleeve" in name for name in names):
        return "tshirt"
    if "crotch" in names:
        return "pants"
    if names >= set(CORNERS):
        return "square" if kind == "square" else "rectangle"
    return "other"


def _edges(content: Mapping[str, Any]) -> dict[str, str]:
    """Parts of a garment that lie along one edge, told by the names of their vertices."""
    vertices, parts = content.get("vertices"), content.get("parts")
    if not isinstance(vertices, Mapping) or not isinstance(parts, Mapping):
        return {}
    of_edge = {edge: set(edge_vertices(vertices, edge)) for edge in ("left", "right", "top", "bottom")}
    found = {}
    for part, names in parts.items():
        on = [edge for edge, members in of_edge.items() if isinstance(names, list) and names and members >= set(names)]
        if len(on) == 1 and len(names) > 1:
            found[str(part)] = on[0]
    return found
