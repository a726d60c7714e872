"""Miller's pattern search, the optimiser of the paper's polygon model: kept to compare with, some ten times slower."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.polygon import Generator, Template
from polyfold_grounding.fitting.energy import Energy, FreeVertices
from polyfold_grounding.fitting.evidence import Evidence
from polyfold_grounding.fitting.flat import FlatFit, spread_starts

__all__ = ["fit_flat_by_pattern", "pattern_search"]

Floats = NDArray[np.float64]

_FIRST_STEP = 10.0
"""First change of every parameter [px at scale 1]; a heading changes by as much at the garment's rim."""

_LAST_STEP = 0.15
"""Change below which a parameter is settled [px at scale 1]."""


def fit_flat_by_pattern(template: Template, evidence: Evidence, rotations: int = 24) -> list[FlatFit]:
    """Fit the template at any rotation with the stages of :func:`polyfold_grounding.fitting.flat.fit_flat`."""
    energy = Energy(template, evidence, 6.0)
    symmetric = []
    for start in spread_starts(template, evidence, rotations):
        vertices, value = pattern_search(energy, template.generator, start.vertices)
        symmetric.append(FlatFit(vertices, value, start.heading))
    symmetric.sort(key=lambda fit: fit.energy)
    free = []
    for fit in symmetric[:2]:
        vertices, value = pattern_search(energy, FreeVertices(), fit.vertices)
        free.append(FlatFit(vertices, value, fit.heading))
    return sorted(free, key=lambda fit: fit.energy)


def pattern_search(energy: Energy, generator: Generator, vertices: Floats, rounds: int = 60) -> tuple[Floats, float]:
    """Coordinate-wise search: a step that helps grows its parameter's step, one that doesn't turns and halves it.

    Returns:
        The vertices found, shape (V, 2), and their energy.
    """
    parameters = generator.parameters(vertices)
    scale = energy.evidence.scale
    reach = np.linalg.norm(generator.jacobian(parameters).reshape(-1, len(parameters)), axis=0)
    steps = _FIRST_STEP * scale / np.maximum(reach / reach.min(), 1.0)
    smallest = steps * _LAST_STEP / _FIRST_STEP
    best = energy.value(generator.vertices(parameters))
    for _ in range(rounds):
        for k in range(len(parameters)):
            for direction in (1.0, -1.0):
                trial = parameters.copy()
                trial[k] += direction * steps[k]
                value = energy.value(generator.vertices(trial))
                if value < best:
                    parameters, best = trial, value
                    steps[k] *= direction * 1.3
                    break
            else:
                steps[k] *= 0.5
        if np.all(np.abs(steps) < smallest):
            break
    return generator.vertices(parameters), best
