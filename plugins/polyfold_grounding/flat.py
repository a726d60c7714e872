"""Fitting a flat garment at any rotation: starts, a symmetric stage, then every vertex on its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import polygon_area, rotate
from polyfold.polygon import Template
from polyfold_grounding.energy import Energy, FreeVertices, minimise_energy
from polyfold_grounding.evidence import Evidence

__all__ = ["FlatFit", "Start", "fit_flat", "spread_starts"]

Floats = NDArray[np.float64]

_STARTS, _APART = 16, np.radians(15.0)
"""How many headings go through the symmetric stage, and their least distance."""

_FREE = 8
"""How many of them go through the free stage."""

_DELTA, _FAR_DELTA = 4.0, 12.0
"""Distance [px at scale 1] beyond which a contour sample counts linearly: at the end, and before that, when far
samples are still to pull the free vertices out of shallow minima."""

_SHARP = 30.0
"""Least turn of the outline at a protruding corner [deg]."""

_ROUNDING = 15.0
"""How far outside a rounded corner a vertex may end up [px at scale 1]."""


@dataclass(frozen=True, eq=False)
class FlatFit:
    """One explanation of the silhouette.

    Attributes:
        vertices: the polygon [px], shape (V, 2).
        energy: contour distance plus Γ, without unit.
        heading: direction of the garment's left-to-right axis at the start [rad].
    """

    vertices: Floats
    energy: float
    heading: float


@dataclass(frozen=True, eq=False)
class Start:
    """A canonical shape, scaled and turned into the picture."""

    vertices: Floats
    heading: float
    energy: float


def fit_flat(template: Template, evidence: Evidence, rotations: int = 24) -> list[FlatFit]:
    """Fit the template at any rotation.

    Returns:
        Explanations with different headings, best first; at least one.
    """
    objective, far_sighted = (Energy(template, evidence, delta) for delta in (_DELTA, _FAR_DELTA))
    symmetric = []
    for start in spread_starts(template, evidence, rotations):
        vertices, energy = minimise_energy(objective, template.generator, start.vertices, 15)
        symmetric.append(FlatFit(vertices, energy, start.heading))
    symmetric.sort(key=lambda fit: fit.energy)
    free = []
    for fit in symmetric[:_FREE]:
        vertices, _ = minimise_energy(far_sighted, FreeVertices(), fit.vertices, 40)
        vertices, energy = minimise_energy(objective, FreeVertices(), vertices, 40)
        free.append(FlatFit(on_contour(template, vertices, evidence), energy, fit.heading))
    return sorted(free, key=lambda fit: fit.energy)


def on_contour(template: Template, vertices: Floats, evidence: Evidence) -> Floats:
    """Vertices drawn onto the nearby contour: real corners are rounded, and the best polygon's lie outside of them.

    A protruding corner goes to the point that protrudes most, any other to the nearest one. Only points along the same
    stretch of the contour count: the corner of the other trouser leg may be near, too.
    """
    before, after = np.roll(vertices, 1, axis=0) - vertices, np.roll(vertices, -1, axis=0) - vertices
    before, after = (arm / np.maximum(np.linalg.norm(arm, axis=1, keepdims=True), 1e-9) for arm in (before, after))
    outward = -(before + after) / np.maximum(np.linalg.norm(before + after, axis=1, keepdims=True), 1e-9)
    sharp = (before * after).sum(1) > -np.cos(np.radians(_SHARP))
    turns = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]
    convex = turns * polygon_area(vertices) > 0
    offsets = evidence.contour[None] - vertices[:, None]
    distance = np.linalg.norm(offsets, axis=2)
    reach = _ROUNDING * evidence.scale
    along = (offsets * outward[:, None]).sum(2)
    merit = np.where(
        (sharp & convex)[:, None], along - 0.5 * np.sqrt(np.maximum(distance**2 - along**2, 0.0)), -distance
    )
    count = len(evidence.contour)
    steps = np.abs(np.arange(count)[None] - distance.argmin(1)[:, None])
    spacing = np.hypot(*(evidence.contour[1] - evidence.contour[0]))
    here = (distance < reach) & (np.minimum(steps, count - steps) * spacing < 1.5 * reach)
    chosen = np.where(here, merit, -np.inf).argmax(1)
    moved = (distance.min(1) < reach) & ~np.isin(template.names, template.covered)
    return np.where(moved[:, None], evidence.contour[chosen], vertices)


def spread_starts(template: Template, evidence: Evidence, rotations: int) -> list[Start]:
    """The best starts whose headings differ."""
    return _apart(_starts(template, evidence, rotations), _STARTS, _APART)


def _starts(template: Template, evidence: Evidence, rotations: int) -> list[Start]:
    """Every canonical shape at every rotation, with the cloth's area and centroid, best first."""
    energy = Energy(template, evidence, _DELTA)
    area, centre = abs(polygon_area(evidence.contour)), _centroid(evidence.contour)
    # The names of a cyclic template are handed out later, so that a quarter turn covers all of its headings.
    span = np.pi / 2 if template.cyclic else 2 * np.pi
    found = []
    for shape in template.canonical_shapes:
        scaled = (shape - _centroid(shape)) * np.sqrt(area / abs(polygon_area(shape)))
        for heading in np.arange(rotations) * span / rotations:
            vertices = rotate(scaled, heading) + centre
            found.append(Start(vertices, float(heading), energy.value(vertices)))
    return sorted(found, key=lambda start: start.energy)


def _apart(ordered: Sequence[Start], count: int, angle: float) -> list[Start]:
    """The first ``count`` whose headings differ by at least ``angle`` [rad]."""
    chosen: list[Start] = []
    for start in ordered:
        turns = [abs((start.heading - other.heading + np.pi) % (2 * np.pi) - np.pi) for other in chosen]
        if all(turn >= angle - 1e-9 for turn in turns):
            chosen.append(start)
        if len(chosen) == count:
            break
    return chosen


def _centroid(polygon: Floats) -> Floats:
    following = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]
    return ((polygon + following) * cross[:, None]).sum(0) / (3.0 * cross.sum())
