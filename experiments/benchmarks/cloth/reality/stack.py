"""Separate plies on the table: how high, how calm and how steady is a pile of them?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import Cloth
from experiments.benchmarks.cloth.reality.rows import Row, millimetres
from experiments.benchmarks.cloth.reality.sheets import lifted, pile, square
from polyfold.garments import Fabric

SIDE = 0.15
"""Of the squares [m]."""
PLIES = (2, 4, 8, 16)
SPACED = 1.5
"""The plies start so many thicknesses apart."""
ASIDE = 0.004
"""Each ply lies at most so far beside its place, both ways [m]: exactly in line, every vertex would lie on a vertex."""
SETTLING, RESTING = 1.5, 5.0
"""Time to come to rest, and to lie and be watched [s]."""
WINDOW = 0.1
"""Time over which a displacement counts as a speed [s]."""


@dataclass(frozen=True)
class Pile:
    """A pile at rest.

    Attributes:
        height: from the table to the top of the upper ply [m].
        speed: vertical, root mean square over particles and time, as the solver says [m/s].
        shift: the same from where the particles are :data:`WINDOW` apart [m/s]: trembling in place does not count.
        creep: mean distance that particles come in five seconds [m].
    """

    height: float
    speed: float
    shift: float
    creep: float


def lay(fabric: Fabric, plies: int, edge_length: float) -> Pile:
    """Let a pile of squares down and watch it lie."""
    sheet = square(SIDE, edge_length)
    levels = fabric.thickness * (0.5 + SPACED * np.arange(plies))
    aside = np.random.default_rng(plies).uniform(-ASIDE, ASIDE, (plies, 2))
    laid = [lifted(sheet.vertices + shift, level) for shift, level in zip(aside, levels, strict=True)]
    cloth = Cloth(pile(sheet, plies), fabric, np.vstack(laid))
    cloth.wait(SETTLING)
    before = cloth.positions()
    speeds, heights = [], [before[:, 2]]

    def look() -> None:
        speeds.append(cloth.velocities()[:, 2])
        heights.append(cloth.positions()[:, 2])

    looks = 5
    cloth.wait(RESTING, look, WINDOW / looks)
    after = cloth.positions()
    top = after[-len(sheet.vertices) :, 2].mean() + fabric.thickness / 2
    shifts = np.diff(np.array(heights[::looks]), axis=0) / WINDOW
    creep = np.linalg.norm(after - before, axis=1).mean()
    return Pile(float(top), _rms(np.array(speeds)), _rms(shifts), float(creep))


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt((values**2).mean()))


def stack_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Height per ply, vertical speed and creep of piles of 2 to 16 plies."""
    for plies in PLIES:
        result = lay(fabric, plies, edge_length)
        yield Row(
            "stack",
            fabric.name,
            f"{plies} plies: height per ply, vertical speed RMS and over 0.1 s, creep in 5 s",
            f"{millimetres(fabric.thickness, 2)} (thickness), 0 mm/s, 0 mm; bars 1 mm/s, 2 mm",
            f"{millimetres(result.height / plies, 2)}, {1000 * result.speed:.2f} and "
            f"{1000 * result.shift:.2f} mm/s, {millimetres(result.creep, 2)}",
            f"{plies} plies",
        )
