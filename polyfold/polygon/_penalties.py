"""The structural penalty of a template: ranges that angles, length ratios and positions of its vertices must keep.

A penalty compares two vectors between vertices and costs nothing inside its range, ½ (violation / σ)² outside. All of
them together are evaluated at once, with analytic derivatives, by :class:`PenaltySet`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError

Floats = NDArray[np.float64]

Place = str | tuple[str, ...]
"""A vertex name, or several whose mean is meant."""

Vector = tuple[Place, Place]
"""From one place to another."""

Measure = Literal["angle", "ratio", "position", "offset"]
_MEASURES: tuple[Measure, ...] = ("angle", "ratio", "position", "offset")


@dataclass(frozen=True)
class Penalty:
    """A range ``[low, high]`` with softness ``sigma`` for one measure of the vectors ``of`` and ``to``.

    Make one with :func:`angle_range`, :func:`ratio_range`, :func:`position_range` or :func:`offset_range`.
    """

    measure: Measure
    of: Vector
    to: Vector
    low: float
    high: float
    sigma: float

    def __post_init__(self) -> None:
        if not (self.low <= self.high and self.sigma > 0):
            raise GarmentError(
                f"a penalty needs low <= high and sigma > 0, got {self.low}, {self.high}, {self.sigma}; "
                "correct its range"
            )


def angle_range(of: Vector, to: Vector, low: float, high: float, sigma: float = 5.0) -> Penalty:
    """Signed angle [deg] from the vector ``to`` to the vector ``of``; positive is clockwise as seen in the image."""
    return Penalty("angle", of, to, low, high, sigma)


def ratio_range(of: Vector, to: Vector, low: float, high: float, sigma: float = 0.1) -> Penalty:
    """Length of ``of`` over length of ``to``."""
    return Penalty("ratio", of, to, low, high, sigma)


def position_range(point: Place, along: Vector, low: float, high: float, sigma: float = 0.05) -> Penalty:
    """Where ``point`` projects onto the segment ``along``: 0 at its start, 1 at its end."""
    return Penalty("position", (along[0], point), along, low, high, sigma)


def offset_range(point: Place, along: Vector, low: float, high: float, sigma: float = 0.05) -> Penalty:
    """How far ``point`` lies beside the segment ``along``, in its lengths; positive on its right in the image."""
    return Penalty("offset", (along[0], point), along, low, high, sigma)


class PenaltySet:
    """All penalties of a template over vertices in polygon order, as arrays."""

    def __init__(self, penalties: Iterable[Penalty], names: Sequence[str]) -> None:
        self.penalties = tuple(penalties)
        self._of = np.array([_weights(p.of, names) for p in self.penalties]).reshape(-1, len(names))
        self._to = np.array([_weights(p.to, names) for p in self.penalties]).reshape(-1, len(names))
        self._low = np.array([p.low for p in self.penalties])
        self._high = np.array([p.high for p in self.penalties])
        self._sigma = np.array([p.sigma for p in self.penalties])
        kinds = np.array([_MEASURES.index(p.measure) for p in self.penalties], int)
        self._is = [kinds == k for k in range(len(_MEASURES))]

    def __len__(self) -> int:
        return len(self.penalties)

    def residuals(self, vertices: ArrayLike) -> Floats:
        """Violation / σ of each penalty, shape (P,); zero inside its range."""
        values, _, _ = self._measure(np.asarray(vertices, float))
        return self._violation(values) / self._sigma

    def energy(self, vertices: ArrayLike) -> float:
        """Γ = ½ Σ (violation / σ)² of vertices, shape (V, 2)."""
        return 0.5 * float(np.sum(self.residuals(vertices) ** 2))

    def residuals_and_jacobian(self, vertices: Floats) -> tuple[Floats, Floats]:
        """Residuals, shape (P,), and their derivatives by the vertices, shape (P, V, 2)."""
        values, by_of, by_to = self._measure(vertices)
        violation = self._violation(values)
        active = (violation != 0.0) / self._sigma
        jacobian = self._of[:, :, None] * by_of[:, None, :] + self._to[:, :, None] * by_to[:, None, :]
        return violation / self._sigma, jacobian * active[:, None, None]

    def _violation(self, values: Floats) -> Floats:
        return np.minimum(values - self._low, 0.0) + np.maximum(values - self._high, 0.0)

    def _measure(self, vertices: Floats) -> tuple[Floats, Floats, Floats]:
        """Values, shape (P,), and derivatives by the two vectors, shape (P, 2) each."""
        u, w = self._of @ vertices, self._to @ vertices
        u2 = np.maximum((u * u).sum(1), 1e-12)
        w2 = np.maximum((w * w).sum(1), 1e-12)
        dot, cross = (u * w).sum(1), w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]
        turned_u, turned_w = np.column_stack([-u[:, 1], u[:, 0]]), np.column_stack([-w[:, 1], w[:, 0]])
        values, by_u, by_w = np.empty(len(u)), np.empty_like(u), np.empty_like(w)

        k = self._is[0]
        # The angle is cut opposite the middle of the range, so that it is continuous wherever it is used.
        middle = 0.5 * (self._low[k] + self._high[k])
        degrees = np.degrees(np.arctan2(cross[k], dot[k]))
        values[k] = (degrees - middle + 180.0) % 360.0 - 180.0 + middle
        by_u[k] = np.degrees(turned_u[k] / u2[k, None])
        by_w[k] = -np.degrees(turned_w[k] / w2[k, None])

        k = self._is[1]
        values[k] = np.sqrt(u2[k] / w2[k])
        by_u[k] = (values[k] / u2[k])[:, None] * u[k]
        by_w[k] = -(values[k] / w2[k])[:, None] * w[k]

        k = self._is[2]
        values[k] = dot[k] / w2[k]
        by_u[k] = w[k] / w2[k, None]
        by_w[k] = (u[k] - 2.0 * values[k, None] * w[k]) / w2[k, None]

        k = self._is[3]
        values[k] = cross[k] / w2[k]
        by_u[k] = turned_w[k] / w2[k, None]
        by_w[k] = (-turned_u[k] - 2.0 * values[k, None] * w[k]) / w2[k, None]
        return values, by_u, by_w


def _weights(vector: Vector, names: Sequence[str]) -> Floats:
    """Coefficients of the vertices whose sum is the vector."""
    weights = np.zeros(len(names))
    for place, sign in zip(vector, (-1.0, 1.0), strict=True):
        group = (place,) if isinstance(place, str) else place
        for name in group:
            if name not in names:
                raise GarmentError(f"a penalty names the vertex {name!r}; the template has {', '.join(names)}")
            weights[list(names).index(name)] += sign / len(group)
    return weights
