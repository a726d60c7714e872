"""Fitting a flat garment at any rotation: starts, a symmetric stage, then every vertex on its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import polygon_area, rotate
from polyfold.polygon import Template
from polyfold_grounding.fitting.blunt_corners import with_blunt_corners
from polyfold_grounding.fitting.corners import on_contour
from polyfold_grounding.fitting.energy import Energy, FreeVertices, minimise_energy
from polyfold_grounding.fitting.evidence import Evidence

__all__ = ["FlatFit", "Start", "fit_flat", "spread_starts"]

Floats = NDArray[np.float64]

_STARTS, _APART = 16, np.radians(15.0)
"""How many headings go through the symmetric stage, and their least distance."""

_FREE = 8
"""How many of them go through the free stage."""

_DELTA, _FAR_DELTA = 4.0, 12.0
"""Distance [px at scale 1] beyond which a contour sample counts linearly: at the end, and before that, when far
samples are still to pull the free vertices out of shallow minima."""


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
    best, *others = sorted(free, key=lambda fit: fit.energy)
    return [replace(best, vertices=with_blunt_corners(template, best.vertices, evidence)), *others]


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
