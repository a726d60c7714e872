"""The energy of a flat garment, ½ D(model → cloth) + ½ D(cloth → model) plus Γ, and its minimisation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from polyfold.polygon import Generator, Template
from polyfold_grounding import contour_terms
from polyfold_grounding.evidence import Evidence
from polyfold_grounding.levenberg_marquardt import Damping, Terms, minimise

__all__ = ["Energy", "FreeVertices", "minimise_energy"]

Floats = NDArray[np.float64]

_SAMPLES = 300

_WEIGHT = 30.0
"""How much a mean square distance of 1 px (at scale 1) weighs against one σ of a penalty."""

_DAMPING = Damping(most=1e7, share=1e-6, least=1e-12)


@dataclass(frozen=True, eq=False)
class Energy:
    """Contour distance to the evidence plus the template's structural penalty.

    Attributes:
        template: gives Γ.
        evidence: the cloth's contour.
        delta: beyond this distance [px at scale 1] a sample counts linearly (pseudo-Huber).
    """

    template: Template
    evidence: Evidence
    delta: float

    def value(self, vertices: Floats) -> float:
        """The energy of a polygon, shape (V, 2)."""
        return self._weight * self._contour(contour_terms.contour_cost, vertices)[0] + self.template.penalties.energy(
            vertices
        )

    def chamfer(self, vertices: Floats) -> float:
        """Chamfer distance between polygon and contour [px]."""
        return self._contour(contour_terms.contour_cost, vertices)[1]

    def normal_equations(self, vertices: Floats) -> tuple[float, Floats, Floats]:
        """Energy, gradient, shape (2V,), and Gauss-Newton Hessian, shape (2V, 2V), by the vertices."""
        cost, gradient, hessian = self._contour(contour_terms.contour_normal_equations, vertices)
        residuals, jacobian = self.template.penalties.residuals_and_jacobian(vertices)
        active = residuals != 0.0
        residuals, jacobian = residuals[active], jacobian[active].reshape(-1, vertices.size)
        return (
            self._weight * cost + 0.5 * float(residuals @ residuals),
            self._weight * gradient + jacobian.T @ residuals,
            self._weight * hessian + jacobian.T @ jacobian,
        )

    @cached_property
    def _covered(self) -> NDArray[np.bool_]:
        """Which edges, from each vertex to the next, may lie under other cloth."""
        ends = np.isin(self.template.names, self.template.covered)
        return ends | np.roll(ends, -1)

    @property
    def _weight(self) -> float:
        return _WEIGHT / self.evidence.scale**2

    def _contour(self, function, vertices: Floats):
        evidence = self.evidence
        delta = self.delta * evidence.scale
        return function(
            np.ascontiguousarray(vertices),
            self._covered,
            evidence.samples,
            evidence.field,
            evidence.margin,
            delta,
            _SAMPLES,
        )


class FreeVertices:
    """The generator of the last stage: every vertex on its own."""

    def parameters(self, vertices: Floats) -> Floats:
        """The vertices themselves, shape (2V,)."""
        return np.asarray(vertices, float).ravel()

    def vertices(self, parameters: Floats) -> Floats:
        """The polygon, shape (V, 2)."""
        return parameters.reshape(-1, 2)

    def jacobian(self, parameters: Floats) -> Floats:
        """Identity, shape (V, 2, 2V)."""
        return np.eye(len(parameters)).reshape(-1, 2, len(parameters))


def minimise_energy(energy: Energy, generator: Generator, vertices: Floats, iterations: int) -> tuple[Floats, float]:
    """Minimise from the generator's polygon closest to ``vertices`` [px], shape (V, 2).

    Returns:
        The vertices found [px], shape (V, 2), and their energy.
    """

    def terms(parameters: Floats) -> Terms:
        cost, gradient, hessian = energy.normal_equations(generator.vertices(parameters))
        jacobian = generator.jacobian(parameters).reshape(-1, len(parameters))
        return Terms(cost, jacobian.T @ gradient, jacobian.T @ hessian @ jacobian)

    parameters, found = minimise(terms, generator.parameters(vertices), iterations, _DAMPING)
    return generator.vertices(parameters), found.cost
