"""The Levenberg-Marquardt method, for the fit of a flat garment and for the refit after a fold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["Damping", "Terms", "minimise"]

Floats = NDArray[np.float64]

_FIRST, _LEAST = 1e-2, 1e-7
"""Damping at the start, and the least that it falls to."""


@dataclass(frozen=True, eq=False)
class Terms:
    """A sum of squares around some parameters.

    Attributes:
        cost: its value, without unit.
        gradient: by the parameters, shape (P,).
        hessian: Gauss-Newton's, shape (P, P).
    """

    cost: float
    gradient: Floats
    hessian: Floats


@dataclass(frozen=True)
class Damping:
    """How the normal equations are kept solvable.

    Attributes:
        most: damping at which the search gives up.
        share: of the Hessian's mean diagonal, added to the diagonal before it is scaled by the damping.
        least: added to the diagonal before it is scaled, too.
        floor: added to the scaled diagonal.
    """

    most: float
    share: float = 0.0
    least: float = 0.0
    floor: float = 0.0

    def damped(self, hessian: Floats, damping: float) -> Floats:
        """The Hessian with a heavier diagonal, shape (P, P)."""
        diagonal = np.diag(hessian)
        scale = diagonal + self.share * np.trace(hessian) / len(diagonal) + self.least
        return hessian + np.diag(damping * scale + self.floor)


T = TypeVar("T", bound=Terms)


def minimise(
    terms: Callable[[Floats], T], start: Floats, iterations: int, damping: Damping, tolerance: float = 1e-3
) -> tuple[Floats, T]:
    """Descend from ``start``, shape (P,), until a step gains less than a share ``tolerance`` of the cost.

    Args:
        terms: the sum of squares around given parameters, shape (P,).
        start: the first parameters, shape (P,).
        iterations: steps tried at most.
        damping: how the normal equations are kept solvable.
        tolerance: share of the cost (of 1 where that is less) whose gain is worth going on.

    Returns:
        The parameters found, shape (P,), and the terms there.
    """
    parameters, here, factor = start, terms(start), _FIRST
    for _ in range(iterations):
        trial = parameters - np.linalg.solve(damping.damped(here.hessian, factor), here.gradient)
        there = terms(trial)
        if there.cost < here.cost:
            gain = here.cost - there.cost
            parameters, here = trial, there
            factor = max(factor / 4, _LEAST)
            if gain < tolerance * max(here.cost, 1.0):
                break
        else:
            factor *= 6
            if factor > damping.most:
                break
    return parameters, here
