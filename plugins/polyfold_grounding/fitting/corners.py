"""Where a fitted polygon's corners lie on the contour, which is rounded where the polygon is not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import polygon_area
from polyfold.polygon import Template
from polyfold_grounding.fitting.evidence import Evidence

__all__ = ["Corners", "on_contour"]

Floats = NDArray[np.float64]

_SHARP = 30.0
"""Least turn of the outline at a protruding corner [deg]."""

_ROUNDING = 15.0
"""How far outside a rounded corner a vertex may end up [px at scale 1]."""


@dataclass(frozen=True, eq=False)
class Corners:
    """How a polygon turns at each vertex.

    Attributes:
        outward: unit vectors that halve the angle, shape (V, 2).
        sharp: whether it turns by 30 degrees or more, shape (V,).
        convex: whether it turns the way a convex polygon does, shape (V,).
    """

    outward: Floats
    sharp: NDArray[np.bool_]
    convex: NDArray[np.bool_]

    @classmethod
    def of(cls, vertices: Floats) -> Corners:
        """The corners of a polygon [px], shape (V, 2)."""
        before, after = np.roll(vertices, 1, axis=0) - vertices, np.roll(vertices, -1, axis=0) - vertices
        before, after = (arm / np.maximum(np.linalg.norm(arm, axis=1, keepdims=True), 1e-9) for arm in (before, after))
        outward = -(before + after) / np.maximum(np.linalg.norm(before + after, axis=1, keepdims=True), 1e-9)
        turns = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]
        sharp = (before * after).sum(1) > -np.cos(np.radians(_SHARP))
        return cls(outward, sharp, turns * polygon_area(vertices) > 0)


def on_contour(template: Template, vertices: Floats, evidence: Evidence) -> Floats:
    """Vertices drawn onto the nearby contour: real corners are rounded, and the best polygon's lie outside of them.

    A protruding corner goes to the point that protrudes most, any other to the nearest one. Only points along the same
    stretch of the contour count: the corner of the other trouser leg may be near, too.
    """
    corners = Corners.of(vertices)
    offsets = evidence.contour[None] - vertices[:, None]
    distance = np.linalg.norm(offsets, axis=2)
    reach = _ROUNDING * evidence.scale
    along = (offsets * corners.outward[:, None]).sum(2)
    merit = np.where(
        (corners.sharp & corners.convex)[:, None],
        along - 0.5 * np.sqrt(np.maximum(distance**2 - along**2, 0.0)),
        -distance,
    )
    count = len(evidence.contour)
    steps = np.abs(np.arange(count)[None] - distance.argmin(1)[:, None])
    spacing = np.hypot(*(evidence.contour[1] - evidence.contour[0]))
    here = (distance < reach) & (np.minimum(steps, count - steps) * spacing < 1.5 * reach)
    chosen = np.where(here, merit, -np.inf).argmax(1)
    moved = (distance.min(1) < reach) & ~np.isin(template.names, template.covered)
    return np.where(moved[:, None], evidence.contour[chosen], vertices)
