"""Corners at which the outline hardly turns, such as a shoulder: where two curved edges meet, not two straight ones.

The polygon's edges are straight, a garment's are not: a sleeve's upper edge that bulges by 1 % of its length moves the
best polygon's shoulder by several pixels along the contour, and with it every fold line through the shoulder.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import resample
from polyfold.polygon import Template
from polyfold_grounding.fitting.corners import Corners
from polyfold_grounding.fitting.evidence import Evidence

__all__ = ["with_blunt_corners"]

Floats = NDArray[np.float64]

_BULGE = 3.0
"""How far the middle of an edge usually lies off the straight line [px at scale 1]."""

_ROUNDING = 6.0
"""How far from the corner its rounding begins [px at scale 1]."""

_ENDS = 3.0
"""How much of the outline at its ends belongs to the neighbours' roundings [px at scale 1]."""

_MISFIT = 0.5
"""How far an outline waves about two arcs [px at scale 1, independent from pixel to pixel]."""

_USUAL = 0.17
"""Misfit per px of outline at the best place; smooth outlines stay below it, because pixels wave together."""

_SHARES = (0.1, 0.9)
"""Where between its neighbours the corner is looked for, as a share of the way."""

_STEP = 3.0
"""How far apart the places are that it is looked for at [px at scale 1]."""


_ROUNDS = 2
"""Γ compares a garment's two sides: where one shoulder goes depends a little on where the other one is."""


def with_blunt_corners(template: Template, vertices: Floats, evidence: Evidence) -> Floats:
    """The polygon with those vertices moved along the contour at which it hardly turns.

    Each goes to the mean of the places where it may be, weighted by how well two arcs that meet there in a rounded
    corner explain the contour between its neighbours, and by the template's Γ; the best place alone would be an
    accident where many are nearly as good.

    Args:
        template: gives Γ.
        vertices: on the contour [px], shape (V, 2).
        evidence: the cloth's contour.
    """
    blunt = ~Corners.of(vertices).sharp & ~np.isin(template.names, template.covered)
    found = vertices.copy()
    for vertex in [*np.flatnonzero(blunt)] * _ROUNDS:
        found[vertex] = _moved(template, found, int(vertex), evidence)
    return found


def _moved(template: Template, vertices: Floats, vertex: int, evidence: Evidence) -> Floats:
    """Where one blunt corner lies [px], shape (2,); where it was if its neighbours are too near to tell."""
    start, end = vertices[vertex - 1], vertices[(vertex + 1) % len(vertices)]
    stretch = _between(evidence.contour, start, end)
    length = float(np.hypot(*(end - start))) / evidence.scale
    if length < 4 * (_ENDS + _ROUNDING):
        return vertices[vertex]
    along, across = _in_frame(resample(stretch, int(length) + 1, closed=False), start, end, evidence.scale)
    places = np.arange(_SHARES[0] * length, _SHARES[1] * length, _STEP)
    cost = np.array([_misfit(along, across, place) for place in places])
    # An outline that no two arcs explain well says less about where they would meet.
    cost /= max(1.0, cost.min() / (_USUAL * len(along)))
    points = _on_stretch(stretch, start, end, places / length)
    cost += [_penalty(template, vertices, vertex, point) for point in points]
    weight = np.exp(cost.min() - cost)
    middle = float(weight @ places / weight.sum())
    return _on_stretch(stretch, start, end, np.array([middle / length]))[0]


def _between(contour: Floats, start: Floats, end: Floats) -> Floats:
    """The contour [px] from near one point to near another, the shorter way round, shape (N, 2)."""
    first, last = (int(np.hypot(*(contour - point).T).argmin()) for point in (start, end))
    count = len(contour)
    forward = (last - first) % count
    steps = np.arange(forward + 1) if forward <= count - forward else -np.arange(count - forward + 1)
    return contour[(first + steps) % count]


def _in_frame(points: Floats, start: Floats, end: Floats, scale: float) -> tuple[Floats, Floats]:
    """Coordinates [px at scale 1] along the straight line between two points and across it."""
    direction = (end - start) / np.hypot(*(end - start))
    offset = (points - start) / scale
    return offset @ direction, offset @ np.array([-direction[1], direction[0]])


def _on_stretch(stretch: Floats, start: Floats, end: Floats, shares: Floats) -> Floats:
    """Points of the contour [px] at some shares of the straight way between its ends, shape (K, 2)."""
    along, _ = _in_frame(stretch, start, end, float(np.hypot(*(end - start))))
    return stretch[np.abs(along[None] - shares[:, None]).argmin(1)]


def _misfit(along: Floats, across: Floats, place: float) -> float:
    """Negative log-likelihood of an outline, shape (N,) each, for a corner at ``place`` [px at scale 1].

    Two parabolas that meet in a corner whose rounding is a third one; their five coefficients are integrated out.
    """
    length = along[-1]
    inner = (along > _ENDS) & (along < length - _ENDS)
    u, v = along[inner], across[inner]
    beyond = u - place
    bend = np.where(np.abs(beyond) < _ROUNDING, (beyond + _ROUNDING) ** 2 / (4 * _ROUNDING), np.maximum(beyond, 0.0))
    first = np.where(beyond < 0, 4 * u * -beyond / place**2, 0.0)
    second = np.where(beyond > 0, 4 * beyond * (length - u) / (length - place) ** 2, 0.0)
    basis = np.column_stack([np.ones_like(u), u, bend, first, second]) / _MISFIT
    v = v / _MISFIT
    precision = np.diag([1e-6, 1e-6, 1e-6, _BULGE**-2, _BULGE**-2])
    normal = basis.T @ basis + precision
    coefficients = np.linalg.solve(normal, basis.T @ v)
    residual = v - basis @ coefficients
    bulges = float(coefficients @ precision @ coefficients)
    return 0.5 * (float(residual @ residual) + bulges + float(np.linalg.slogdet(normal)[1]))


def _penalty(template: Template, vertices: Floats, vertex: int, point: Floats) -> float:
    """Γ with one vertex elsewhere."""
    moved = vertices.copy()
    moved[vertex] = point
    return template.penalties.energy(moved)
