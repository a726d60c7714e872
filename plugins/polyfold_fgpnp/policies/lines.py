"""Random fold lines across a cloth, from its silhouette alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine
from polyfold.types import Scene
from polyfold_fgpnp.policies.region import FoldRegion, fold_region

Floats = NDArray[np.float64]

LINE_KINDS = ("chord", "corners", "bisector", "middle")
"""How a line is drawn: through two random contour points; through two corners of the outline (along a sleeve); between
two such corners, so that one comes to lie on the other (in half, a corner to the opposite one); through the middle."""

PLAUSIBLE = ("corners", "bisector", "middle")
"""The kinds that a person would fold along."""

WEIGHTS = {"chord": 0.35, "corners": 0.2, "bisector": 0.3, "middle": 0.15}

LEAST_DEPTH, LARGEST_SHARE, LEAST_SHARE = 0.05, 0.65, 0.015
"""A flap reaches at least this share of the image from the line, and is between these shares of the cloth."""

LANDS_INSIDE = 0.995
"""At least this share of the flap's mirror image lies inside the picture; else places would be pulled back."""

ATTEMPTS = 200


@dataclass(frozen=True, eq=False)
class RandomLine:
    """A fold line with what it lifts.

    Attributes:
        kind: one of :data:`LINE_KINDS`.
        line: the directed line [px].
        region: what it lifts.
    """

    kind: str
    line: FoldLine
    region: FoldRegion


def random_line(scene: Scene, rng: np.random.Generator, kinds: tuple[str, ...] = LINE_KINDS) -> RandomLine:
    """A random fold line that lifts a part worth folding and lays it down inside the picture.

    Raises:
        PlanError: if no such line was found, as for cloth that has left the picture.
    """
    corners = outline_corners(scene.contour)
    weights = np.array([WEIGHTS[kind] for kind in kinds])
    for _ in range(ATTEMPTS):
        kind = str(rng.choice(kinds, p=weights / weights.sum()))
        line = _drawn(kind, scene.contour, corners, rng)
        if line is None:
            continue
        try:
            region = fold_region(line, scene)
        except PlanError:
            continue
        if _worth_folding(region, scene.mask):
            return RandomLine(kind, line, region)
    raise PlanError("no fold line across this cloth lifts a usable part; start from a garment that lies in the picture")


def outline_corners(contour: Floats) -> Floats:
    """Corners of a closed outline [px], shape (K, 2): what is left when it is simplified by 1 % of its length."""
    import cv2

    closed = contour.astype(np.float32)
    corners = cv2.approxPolyDP(closed, 0.01 * cv2.arcLength(closed, True), True)
    return corners.reshape(-1, 2).astype(float)


def _drawn(kind: str, contour: Floats, corners: Floats, rng: np.random.Generator) -> FoldLine | None:
    """A line of a kind, in a random direction; None if its two points coincide."""
    if kind == "middle":
        angle = rng.uniform(0, 2 * np.pi)
        middle = (contour.min(0) + contour.max(0)) / 2 + rng.normal(0, 3, 2)
        return FoldLine.between(middle, middle + 50 * np.array([np.cos(angle), np.sin(angle)]))
    points = contour if kind == "chord" else corners
    if len(points) < 2:
        return None
    start, end = points[rng.choice(len(points), 2, replace=False)] + (
        0 if kind == "chord" else rng.normal(0, 2, (2, 2))
    )
    if np.hypot(*(end - start)) < 20:
        return None
    return FoldLine.moving(start, end) if kind == "bisector" else FoldLine.between(start, end)


def _worth_folding(region: FoldRegion, cloth: NDArray[np.bool_]) -> bool:
    share = region.mask.sum() / cloth.sum()
    if region.distances.max() < LEAST_DEPTH * min(cloth.shape) or not LEAST_SHARE <= share <= LARGEST_SHARE:
        return False
    y, x = np.nonzero(region.mask)
    landed = region.fold_line.mirror(np.column_stack([x, y]))
    height, width = cloth.shape
    inside = (landed >= 0).all(1) & (landed[:, 0] <= width - 1) & (landed[:, 1] <= height - 1)
    return bool(inside.mean() >= LANDS_INSIDE)
