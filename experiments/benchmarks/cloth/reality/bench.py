"""The bench that samples are tested on: all that these tests know of the solver's inside stands here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from polyfold_xpbd.solver import MOVING, Solver

from polyfold import plugins
from polyfold.errors import SimulationError
from polyfold.garments import Garment, Mesh

Floats = NDArray[np.float64]

LOOK = 0.2
"""How long a sample is looked at to see whether it is at rest [s]."""
RESTLESS = 0.03
"""Speed of a sample that flutters and has no shape to be measured, RMS [m/s]."""
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Fabric:
    """What a sample is made of.

    Attributes:
        name: as in the table.
        thickness: of one ply [m].
        weight: per area [kg/m²].
        bending_length_warp, bending_length_weft: Peirce's bending length along x and y of the flat mesh [m].
        cloth_friction, table_friction: Coulomb friction.
        crease_yield: curvature from which a bend stays [1/m]; infinite for an elastic fabric.
        crease_set: share of the curvature beyond the yield that stays.
    """

    name: str
    thickness: float
    weight: float
    bending_length_warp: float
    bending_length_weft: float
    cloth_friction: float
    table_friction: float
    crease_yield: float = float("inf")
    crease_set: float = 0.0

    @property
    def bending_length(self) -> float:
        """Mean of warp and weft [m], for a solver that bends alike both ways."""
        return (self.bending_length_warp + self.bending_length_weft) / 2


FABRICS = {
    fabric.name: fabric
    for fabric in (
        Fabric("standard", 0.0035, 0.15, 0.010, 0.010, 0.6, 0.8),
        Fabric("jersey", 0.0008, 0.16, 0.011, 0.009, 0.6, 0.6),
        Fabric("poplin", 0.0008, 0.12, 0.019, 0.016, 0.5, 0.5),
        Fabric("denim", 0.0010, 0.33, 0.022, 0.018, 0.6, 0.6),
    )
}
"""Samples to test. ``standard`` is the simulator's own default; the others have plausible constants."""


def elastic(fabric: Fabric, bending_length: float | None = None) -> Fabric:
    """The same fabric without set, and alike both ways with another bending length [m] if one is given."""
    fabric = replace(fabric, crease_yield=float("inf"), crease_set=0.0)
    if bending_length is None:
        return fabric
    return replace(fabric, bending_length_warp=bending_length, bending_length_weft=bending_length)


class Cloth:
    """One sample of cloth, in any position, with some of its particles held.

    Args:
        mesh: the sample spread flat, see :class:`polyfold.garments.Mesh`.
        fabric: what it is made of.
        positions: where its particles are at first [m], shape (N, 3).
    """

    def __init__(self, mesh: Mesh, fabric: Any, positions: Floats) -> None:
        # Samples are cut along x; the solver's fabrics are of garments, in which the warp is upright.
        warp, weft = fabric.bending_length_warp, fabric.bending_length_weft
        fabric = replace(fabric, bending_length_warp=weft, bending_length_weft=warp)
        self._solver = Solver(mesh, np.asarray(positions, float)[:, :2], fabric)
        self._held = np.zeros(0, np.int64)
        self._place(positions)

    @property
    def substep(self) -> float:
        """The solver's time step [s]."""
        return self._solver.dt

    def positions(self) -> Floats:
        """Where the particles are [m], shape (N, 3)."""
        return self._solver.positions()

    def velocities(self) -> Floats:
        """How fast they are [m/s], shape (N, 3)."""
        return self._solver.velocities()

    def pin(self, particles: Indices) -> None:
        """Hold these particles, and only these, where they are."""
        self._held = np.asarray(particles, np.int64)
        self._solver._mobility[:] = 1.0
        self._solver._mobility[self._held] = 0.0

    def wait(self, seconds: float, watch: Callable[[], None] | None = None, every: float = 0.02) -> None:
        """Let time pass; ``watch`` is called every so many seconds.

        Raises:
            SimulationError: if the sample diverges.
        """
        if not self._solver.wait(seconds, watch, every):
            raise SimulationError("the sample diverged; try a finer or coarser --edge-length, and report it")

    def rest(self, seconds: float) -> float:
        """Let time pass and say how fast the particles still are in its last fifth of a second, RMS [m/s]."""
        squares: list[float] = []
        self.wait(seconds - LOOK)
        self.wait(LOOK, lambda: squares.append(float((self.velocities() ** 2).sum(axis=1).mean())), 0.01)
        return float(np.sqrt(np.mean(squares)))

    def carry(self, paths: Floats) -> None:
        """Move the pinned particles, in the order given to :meth:`pin`, from where they are.

        Args:
            paths: where each is after every substep [m], shape (substeps, pinned, 3).

        Raises:
            SimulationError: if the sample diverges.
        """
        held, arms = self._held.astype(np.uint32), np.arange(len(self._held), dtype=np.uint32)
        offsets = np.zeros((len(held), 3), np.float32)
        motion = (np.zeros((len(held), 2), np.float32), paths.astype(np.float32), np.zeros(len(paths), np.float32))
        tethers = self._solver._tethers.tie(held, arms, offsets)
        if not self._solver._run((held, offsets, arms, *motion, *tethers), len(paths), MOVING, 0.0, None, 0.0):
            raise SimulationError("the sample diverged while it was carried; carry it more slowly, and report it")

    def _place(self, positions: Floats) -> None:
        self._solver.set_state(np.asarray(positions, float), np.zeros((len(positions), 3)), {})


def simulator(fabric: Fabric) -> Any:
    """The simulator that agents fold in, with cloth of this fabric."""
    constants = ("thickness", "bending_length", "cloth_friction", "table_friction")
    return plugins.create("simulators", "xpbd", {name: getattr(fabric, name) for name in constants})


def garment(kind: str, seed: int, edge_length: float, fabric: Fabric) -> Garment:
    """A seeded garment of a kind, meshed at about ``edge_length`` [m], of this fabric."""
    del fabric  # the simulator holds it
    return plugins.create("garments", kind).generate(seed, edge_length)
