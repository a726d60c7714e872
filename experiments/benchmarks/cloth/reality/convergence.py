"""What the mesh decides: the same tests on meshes of 20 to 8 mm."""

from __future__ import annotations

from collections.abc import Iterator

from experiments.benchmarks.cloth.reality.bench import RESTLESS, elastic
from experiments.benchmarks.cloth.reality.cantilever import hang
from experiments.benchmarks.cloth.reality.drape import drape
from experiments.benchmarks.cloth.reality.elastica import cantilever
from experiments.benchmarks.cloth.reality.rows import Row, millimetres, percent
from experiments.benchmarks.cloth.reality.strip_fold import fold_in_simulator
from polyfold.garments import Fabric

EDGE_LENGTHS = (0.020, 0.0155, 0.0125, 0.010, 0.008)
"""[m]"""
OVERHANG, WIDTH = 0.060, 0.1
"""Of the cantilever [m]: three edges of the coarsest mesh."""


def convergence_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Tip of a cantilever, drape coefficient and end of a folded strip, by mesh."""
    del edge_length  # all of them
    exact = -float(cantilever(OVERHANG, fabric.bending_length_weft).up[-1])
    tips = [hang(elastic(fabric), OVERHANG, edge, width=WIDTH) for edge in EDGE_LENGTHS]
    shown = [millimetres(tip.drop) + (" (not at rest)" if tip.speed > RESTLESS else "") for tip in tips]
    yield _row(fabric, f"cantilever of {millimetres(OVERHANG, 0)}, tip down", f"{millimetres(exact)} (elastica)", shown)
    drapes = [drape(fabric, edge) for edge in EDGE_LENGTHS]
    coefficients = [percent(found) + (" (not at rest)" if speed > RESTLESS else "") for found, speed in drapes]
    yield _row(fabric, "drape coefficient", "the same on all", coefficients)
    ends = [millimetres(fold_in_simulator(fabric, edge).misalignment) for edge in EDGE_LENGTHS]
    yield _row(fabric, "folded strip, end beyond the other", "the same on all", ends)


def _row(fabric: Fabric, quantity: str, published: str, ours: list[str]) -> Row:
    meshes = ", ".join(f"{1000 * edge:g}" for edge in EDGE_LENGTHS)
    return Row("convergence", fabric.name, f"{quantity}, meshes of {meshes} mm", published, ", ".join(ours), "1 each")
