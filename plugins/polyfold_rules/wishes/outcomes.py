"""What known fold sequences make of a garment of ordinary proportions: ratios to the flat garment."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PolyfoldError
from polyfold.geometry import polygon_area
from polyfold.polygon import FoldedModel
from polyfold_rules.shapes.creases import crease_of
from polyfold_rules.shapes.folds import Fold
from polyfold_rules.shapes.parts import NotUnderstoodError
from polyfold_rules.shapes.shape import Shape
from polyfold_rules.wishes.sequences import sequences

Point = NDArray[np.float64]

SIZE = (600, 600)

_HALF_SHIRT = {
    "hem": (29, 38), "armpit": (29, -13), "sleeve_bottom": (45, -4), "sleeve_top": (50, -20), "shoulder": (27, -34),
    "neck": (11, -38),
}  # fmt: skip
_HALF_PANTS = {"leg_inner": (6, 50), "leg_outer": (28, 50), "waist": (25, -50)}
"""Right halves of garments as people wear them, in per cent of their longer side, y down; only ratios matter."""


@dataclass(frozen=True)
class Outcome:
    """The end of a sequence; every ratio is to the flat garment.

    Attributes:
        folds: the sequence.
        area: the silhouette's area.
        width, height: extents from left to right and from top to bottom.
        rectangular: its area / that of its bounding rectangle.
        triangular: its area / that of its enclosing triangle.
        slim: short side / long side of its bounding rectangle.
        shift: where its centroid lies from that of the flat garment, in widths and heights, x right, y down.
        points: the sides on which it ends in a point.
        worn: whether it is a garment with an up and a down, not a plain cloth.
    """

    folds: tuple[Fold, ...]
    area: float
    width: float
    height: float
    rectangular: float
    triangular: float
    slim: float
    shift: tuple[float, float]
    points: frozenset[str]
    worn: bool


@cache
def outcomes(kind: str, family: str) -> tuple[Outcome, ...]:
    """The ends of all known sequences, in their order."""
    flat = _flat(kind, family)
    models: dict[tuple[Fold, ...], FoldedModel | None] = {(): flat}
    found = []
    for folds in sequences(family):
        for length in range(1, len(folds) + 1):
            if folds[:length] not in models:
                models[folds[:length]] = _folded(models[folds[: length - 1]], folds[length - 1])
        model = models[folds]
        if model is not None:
            found.append(_measured(folds, model.outline(), flat.outline(), family != "quad"))
    return tuple(found)


def _folded(model: FoldedModel | None, fold: Fold) -> FoldedModel | None:
    """The model after one more fold; None if it can't be done on this garment."""
    if model is None:
        return None
    try:
        return model.fold(crease_of(fold, Shape.from_text(json.loads(model.to_text(SIZE)))).line)
    except (NotUnderstoodError, PolyfoldError):
        return None


def _flat(kind: str, family: str) -> FoldedModel:
    if family == "tshirt":
        points = {**_mirrored(_HALF_SHIRT), "neck_center": (0.0, -30.0)}
        order = ["hem", "armpit", "sleeve_bottom", "sleeve_top", "shoulder", "neck"]
        names = [f"{n}_left" for n in order] + ["neck_center"] + [f"{n}_right" for n in reversed(order)]
    elif family == "pants":
        points = {**_mirrored(_HALF_PANTS), "crotch": (0.0, -18.0)}
        order = ["leg_inner", "leg_outer", "waist"]
        names = [f"{n}_left" for n in order] + [f"{n}_right" for n in reversed(order)] + ["crotch"]
    else:
        width = 50.0 if kind == "square" else 35.0
        points = {"bottom_left": (-width, 50), "top_left": (-width, -50), "top_right": (width, -50)}
        points["bottom_right"] = (width, 50)
        names = list(points)
    rest = np.array([points[name] for name in names], float) * 4 + 300
    return FoldedModel(rest, tuple(names), dict.fromkeys(names, "vertex"), kind=kind)


def _mirrored(half: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    return {f"{name}_{side}": (sign * x, y) for name, (x, y) in half.items() for side, sign in _SIDES.items()}


_SIDES = {"left": -1, "right": 1}


def _measured(folds: tuple[Fold, ...], now: Point, flat: Point, worn: bool) -> Outcome:
    import cv2

    extent, before = np.ptp(now, axis=0), np.ptp(flat, axis=0)
    area = abs(polygon_area(now))
    sides = cv2.minAreaRect(now.astype(np.float32))[1]
    triangle = cv2.minEnclosingTriangle(now.astype(np.float32).reshape(-1, 1, 2))[0]
    shift = (_centroid(now) - _centroid(flat)) / before
    return Outcome(
        folds,
        area / abs(polygon_area(flat)),
        *(extent / before).tolist(),
        rectangular=area / (sides[0] * sides[1]),
        triangular=area / max(triangle, area),
        slim=min(sides) / max(sides),
        shift=(float(shift[0]), float(shift[1])),
        points=_points(now),
        worn=worn,
    )


def _centroid(polygon: Point) -> Point:
    after = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]
    return ((polygon + after) * cross[:, None]).sum(0) / (3 * cross.sum())


def _points(polygon: Point) -> frozenset[str]:
    """The sides of the bounding box that only a point touches."""
    extent = np.ptp(polygon, axis=0)
    found = set()
    for axis, sides in ((0, ("left", "right")), (1, ("top", "bottom"))):
        for side, limit in zip(sides, (polygon.min(0)[axis], polygon.max(0)[axis]), strict=True):
            there = polygon[np.abs(polygon[:, axis] - limit) < 0.03 * extent[axis], 1 - axis]
            if np.ptp(there) < 0.05 * extent[1 - axis]:
                found.add(side)
    return frozenset(found)
