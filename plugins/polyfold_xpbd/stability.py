"""What keeps the solver stable on a mesh: its substep, how far bending looks ahead, and where edges are guarded."""

from __future__ import annotations

import numpy as np

BEND, LEAST_BEND, MOST_BEND = 3.0, 0.15, 0.32
"""Edges are guarded in bends of this angle [rad] per thickness in edge lengths; the least and the most that it is."""
STIFFEST, LEAD = 1.2, 8.0
"""What keeps bending stable: its fastest squared frequency, times the squared substep, times the lead plus one half.

The lead is how far ahead, in substeps, bending looks along the motion, which damps it; no further than it need be.
"""


def time_step(edge_length: float, bending_rate: float = 0.0) -> float:
    """Substep [s] that a mesh of this edge length [m] and this fastest bending [1/s] needs."""
    step = 1 / 750 if edge_length < 0.0128 else 1 / 600
    return min(step, float(np.sqrt(STIFFEST)) / max(bending_rate, 1e-9))


def bending_lead(step: float, bending_rate: float) -> float:
    """How far bending looks ahead [s] at this substep [s] and this fastest bending [1/s]."""
    return step * min(LEAD, STIFFEST / max(step * bending_rate, 1e-9) ** 2 - 0.5)


def bent_normal(thickness: float) -> float:
    """Length of a mean normal below which edges are guarded against edges; ``thickness`` in edge lengths.

    Vertices on triangles alone let sheets bent by an angle into each other by about a quarter of it, in edge lengths.
    """
    return float(np.cos(np.clip(BEND * thickness, LEAST_BEND, MOST_BEND)))
