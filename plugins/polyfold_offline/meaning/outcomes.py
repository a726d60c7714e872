"""What known fold sequences make of a garment of ordinary proportions: ratios to the flat garment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PolyfoldError
from polyfold.geometry import polygon_area
from polyfold.polygon import FoldedModel
from polyfold_offline.cloth.creases import crease_of
from polyfold_offline.cloth.folds import Fold
from polyfold_offline.cloth.garment import NotUnderstoodError
from polyfold_offline.cloth.shape import Shape
from polyfold_offline.meaning.sequences import sequences

Point = NDArray[np.float64]

SIZE = (600, 600)
PX_PER_METRE = 400.0

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
    """

    folds: tuple[Fold, ...]
    area: float
    width: float
    height: float
    rectangular: float
    triangular: float
    slim: float


@cache
def outcomes(family: str) -> tuple[Outcome, ...]:
    """The ends of all known sequences on a family of garments, in their order."""
    flat = _flat(family)
    models: dict[tuple[Fold, ...], FoldedModel | None] = {(): flat}
    found = []
    for folds in sequences(family):
        for length in range(1, len(folds) + 1):
            if folds[:length] not in models:
                models[folds[:length]] = _folded(models[folds[: length - 1]], folds[length - 1])
        model = models[folds]
        if model is not None:
            found.append(_measured(folds, model.outline(), flat.outline()))
    return tuple(found)


def _folded(model: FoldedModel | None, fold: Fold) -> FoldedModel | None:
    """The model after one more fold; None if it can't be done on this garment."""
    if model is None:
        return None
    try:
        return model.fold(crease_of(fold, Shape.of_model(model, SIZE, PX_PER_METRE)).line)
    except (NotUnderstoodError, PolyfoldError):
        return None


def _flat(family: str) -> FoldedModel:
    if family == "tshirt":
        points = {**_mirrored(_HALF_SHIRT), "neck_center": (0.0, -30.0)}
        order = ["hem", "armpit", "sleeve_bottom", "sleeve_top", "shoulder", "neck"]
        names = [f"{n}_left" for n in order] + ["neck_center"] + [f"{n}_right" for n in reversed(order)]
    elif family == "pants":
        points = {**_mirrored(_HALF_PANTS), "crotch": (0.0, -18.0)}
        order = ["leg_inner", "leg_outer", "waist"]
        names = [f"{n}_left" for n in order] + [f"{n}_right" for n in reversed(order)] + ["crotch"]
    else:
        width = 50.0 if family == "square" else 35.0
        points = {"bottom_left": (-width, 50), "top_left": (-width, -50), "top_right": (width, -50)}
        points["bottom_right"] = (width, 50)
        names = list(points)
    rest = np.array([points[name] for name in names], float) * 4 + 300
    return FoldedModel(rest, tuple(names), dict.fromkeys(names, "vertex"), kind=family)


def _mirrored(half: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    return {f"{name}_{side}": (sign * x, y) for name, (x, y) in half.items() for side, sign in _SIDES.items()}


_SIDES = {"left": -1, "right": 1}


def _measured(folds: tuple[Fold, ...], now: Point, flat: Point) -> Outcome:
    import cv2

    extent, before = np.ptp(now, axis=0), np.ptp(flat, axis=0)
    area = abs(polygon_area(now))
    sides = cv2.minAreaRect(now.astype(np.float32))[1]
    triangle = cv2.minEnclosingTriangle(now.astype(np.float32).reshape(-1, 1, 2))[0]
    return Outcome(
        folds,
        area / abs(polygon_area(flat)),
        *(extent / before).tolist(),
        rectangular=area / (sides[0] * sides[1]),
        triangular=area / max(triangle, area),
        slim=min(sides) / max(sides),
    )
