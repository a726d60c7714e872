"""A cloth of which only the corners of its outline are known, in order, without names: where its parts are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold_rules.shapes.parts import Garment, NotUnderstoodError

Floats = NDArray[np.float64]

_FAMILIES = {"tshirt": "tshirt", "pants": "pants", "square": "quad", "rectangle": "quad"}

_ALIGNED = np.radians(4.0)
"""Edges whose directions differ by less run along the same direction of the cloth."""

_RIVAL = 0.4
"""Directions with this share of the longest total are as good; the one nearest to upright is taken."""

_CREASE = 0.75
"""Of two edges that come down from the waist, one shorter than this share of the other is a crease."""

_ROUNDED = 0.12
"""An edge shorter than this share of the longest is a rounded corner."""

_HEM = 0.12
"""Corners within this share of the height from the lowest belong to a t-shirt's hem."""

_SAME_END = 0.1
"""Corners within this share of the extent belong to the same border."""


def is_nameless(cloth: Mapping[str, Any]) -> bool:
    """Whether the text shows points without names."""
    return isinstance(cloth.get("keypoints"), list)


def family_of(kind: str) -> Garment:
    """The garment by its kind alone, since no vertex names tell."""
    return Garment(kind, _FAMILIES.get(kind, "other"))


@dataclass(frozen=True, eq=False)
class Outline:
    """The visible outline in the garment's own upright frame, in which x is right and y UP.

    Attributes:
        kind: garment kind.
        size: (width, height) of the image [px].
        corners: in the image [px], y down, in order along the outline, shape (N, 2).
        right: unit vector of the garment's right in the image, shape (2,).
    """

    kind: str
    size: tuple[int, int]
    corners: Floats
    right: Floats

    @classmethod
    def from_text(cls, content: Mapping[str, Any]) -> Outline:
        """Read the text of nameless keypoints.

        Raises:
            NotUnderstoodError: if there are fewer than three points.
        """
        corners = np.array([[float(x), float(y)] for x, y in content["keypoints"]])
        if len(corners) < 3:
            raise NotUnderstoodError("fewer than three points are shown, which is no outline")
        kind = str(content.get("garment", ""))
        image = content.get("image") or {}
        size = int(image.get("width", 400)), int(image.get("height", 400))
        return cls(kind, size, corners, _right_of(corners, kind))

    @property
    def up(self) -> Floats:
        """Unit vector of the garment's up in the image, shape (2,)."""
        return np.array([self.right[1], -self.right[0]])

    @property
    def framed(self) -> Floats:
        """The corners in the garment's frame [px], y up, shape (N, 2)."""
        return np.column_stack([self.corners @ self.right, self.corners @ self.up])

    def pixel(self, point: Floats) -> Floats:
        """A point of the garment's frame in the image [px], shape (2,)."""
        return point[0] * self.right + point[1] * self.up

    @property
    def tilt(self) -> float:
        """How far the garment is turned from upright [deg], clockwise as seen."""
        return float(np.degrees(np.arctan2(self.right[1], self.right[0])))

    def extent(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates in the garment's frame, each of shape (2,)."""
        framed = self.framed
        return framed.min(0), framed.max(0)

    def width_at_top(self) -> float:
        """Distance between the outermost of the highest corners [px]."""
        framed = self.framed
        low, high = framed[:, 1].min(), framed[:, 1].max()
        return float(np.ptp(framed[framed[:, 1] > high - 0.12 * (high - low), 0]))

    def toward(self, edge: str) -> Floats:
        """The image direction in which an edge lies, shape (2,)."""
        return {"left": -self.right, "right": self.right, "top": self.up, "bottom": -self.up}[edge]

    def border(self, edge: str) -> tuple[float, Floats]:
        """How far the outline reaches towards an edge [px along that direction], and where it does, shape (2,)."""
        level = self.corners @ self.toward(edge)
        chosen = level > level.max() - _SAME_END * float(np.ptp(level))
        return float(level[chosen].mean()), self.corners[chosen].mean(0)

    def corner(self, name: str) -> Floats:
        """The corner of a quadrilateral [px], shape (2,), ``top_left``.

        Raises:
            NotUnderstoodError: if the outline has no corner there: it has been folded away.
        """
        vertical, horizontal = name.split("_")
        low, high = self.extent()
        wanted = np.array([low[0] if horizontal == "left" else high[0], low[1] if vertical == "bottom" else high[1]])
        distance = np.hypot(*(self.framed - wanted).T)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 0.2 * float((high - low).max()):
            raise NotUnderstoodError(f"the outline has no {name.replace('_', ' ')} corner; it may be folded in already")
        return self.corners[nearest]


def _right_of(corners: Floats, kind: str) -> Floats:
    """The garment's right: along the hem of a t-shirt, else along the most edges; nearest to upright if in doubt."""
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*edges.T)
    if kind == "tshirt":
        return _along_hem(corners, edges, lengths)
    angles = _quarter(np.arctan2(edges[:, 1], edges[:, 0]))
    apart = np.abs(_quarter(angles[:, None] - angles[None]))
    totals = (lengths[None] * (apart < _ALIGNED)).sum(1)
    rivals = np.flatnonzero(totals >= _RIVAL * totals.max())
    chosen = rivals[int(np.argmin(np.round(np.abs(angles[rivals]), 1) - 1e-6 * totals[rivals]))]
    alike = apart[chosen] < _ALIGNED
    turn = float(angles[chosen]) + float(np.average(_quarter(angles[alike] - angles[chosen]), weights=lengths[alike]))
    if kind == "pants":
        turn = _by_borders(turn, corners, edges, lengths)
    return np.array([np.cos(turn), np.sin(turn)])


def _by_borders(turn: float, corners: Floats, edges: Floats, lengths: Floats) -> float:
    """The turn [rad] of trousers by the median of what should be level or upright, given a rough one.

    Level are the uppermost and the lowest edge. What comes down from the upper one's ends should be upright on average;
    where one leg lies on the other, the shorter one is the crease between waist and crotch, and that alone is upright.
    """
    up = np.array([np.sin(turn), -np.cos(turn)])
    off = _quarter(np.arctan2(edges[:, 1], edges[:, 0]) - turn)
    across = np.abs(edges @ up) < lengths / 2
    level = corners @ up
    votes = []
    for near in (level > level.max() - 0.15 * np.ptp(level), level < level.min() + 0.15 * np.ptp(level)):
        border = near & np.roll(near, -1) & across
        if border.any():
            votes.append(int(np.argmax(np.where(border, lengths, 0.0))))
    if not votes:
        return turn
    sides = [_next_side(votes[0], step, lengths) for step in (-1, 1)]
    shorter, longer = sorted(sides, key=lambda side: lengths[side])
    upright = off[shorter] if lengths[shorter] < _CREASE * lengths[longer] else (off[shorter] + off[longer]) / 2
    return turn + float(np.median([*off[votes], upright]))


def _next_side(edge: int, step: int, lengths: Floats) -> int:
    """The next edge around the outline that is no rounded corner."""
    count = len(lengths)
    following = [(edge + step * i) % count for i in range(1, count)]
    return next((index for index in following if lengths[index] > _ROUNDED * lengths.max()), following[0])


def _along_hem(corners: Floats, edges: Floats, lengths: Floats) -> Floats:
    """From end to end of the hem, which sags: the lowest corners by the longest lower edge that runs across."""
    middles = corners + edges / 2
    low = middles[:, 1] > (corners[:, 1].min() + corners[:, 1].max()) / 2
    across = np.abs(edges[:, 0]) > np.abs(edges[:, 1])
    if not (low & across).any():
        raise NotUnderstoodError("I see no hem in the outline")
    hem = int(np.argmax(np.where(low & across, lengths, 0.0)))
    along = edges[hem] / lengths[hem]
    along = along if along[0] > 0 else -along
    height = corners @ np.array([along[1], -along[0]])
    lowest = corners[height < height.min() + _HEM * float(np.ptp(height))]
    across = lowest @ along
    along = lowest[int(np.argmax(across))] - lowest[int(np.argmin(across))]
    return along / np.hypot(*along)


def _quarter(angle: Floats) -> Floats:
    """Angles [rad] modulo a quarter turn, from -45 to 45 degrees."""
    return (angle + np.pi / 4) % (np.pi / 2) - np.pi / 4


def pockets(framed: Floats) -> list[tuple[int, int, int, float]]:
    """Concave stretches of a polygon: index of the deepest corner, of the hull corners around it, and its depth [px].

    The hull corners are given in the order of the polygon.

    Args:
        framed: the polygon's corners [px], shape (N, 2).
    """
    count = len(framed)
    hull = _hull_indices(framed)
    found = []
    for start, end in zip(hull, np.roll(hull, -1), strict=True):
        inner = [(start + step) % count for step in range(1, (int(end) - int(start)) % count)]
        if not inner:
            continue
        along = framed[end] - framed[start]
        offsets = framed[inner] - framed[start]
        depth = np.abs(along[0] * offsets[:, 1] - along[1] * offsets[:, 0]) / max(float(np.hypot(*along)), 1e-9)
        deepest = int(np.argmax(depth))
        found.append((inner[deepest], int(start), int(end), float(depth[deepest])))
    return found


def _hull_indices(points: Floats) -> NDArray[np.int64]:
    """Indices of the convex hull's corners, in the order of the polygon."""
    keep = []
    for index, point in enumerate(points):
        others = np.delete(points, index, axis=0) - point
        angles = np.sort(np.arctan2(others[:, 1], others[:, 0]))
        gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
        # A corner of the hull sees all other points within less than half a turn.
        if gaps.max() > np.pi + 1e-9:
            keep.append(index)
    return np.array(keep)
