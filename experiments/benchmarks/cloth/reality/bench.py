"""The bench that samples are tested on: all that these tests know of the solver's inside stands here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from polyfold_xpbd.solver import Solver

from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.errors import SimulationError
from polyfold.garments import Fabric, Garment, Mesh

Floats = NDArray[np.float64]

LOOK = 0.2
"""How long a sample is looked at to see whether it is at rest [s]."""
RESTLESS = 0.03
"""Speed of a sample that flutters and has no shape to be measured, RMS [m/s]."""
Indices = NDArray[np.int64]


FABRICS = ("jersey", "poplin", "denim", "terry", "felt")
"""The bundled fabrics."""


def fabric_named(name: str) -> Fabric:
    """A registered fabric with its own constants.

    Raises:
        PluginError: if there is none of that name.
    """
    return plugins.make_fabric(ComponentSpec(name=name), "square")


def elastic(fabric: Fabric, bending_length: float | None = None) -> Fabric:
    """The same fabric without set, and alike both ways with another bending length [m] if one is given.

    Without a share that stays, the solver bends elastically at any curvature: the limit that its meshes put on the
    elastic range (half of what they can bend) then says nothing.
    """
    fabric = replace(fabric, crease_yield=Fabric.LIMITS["crease_yield"][1], crease_set=0.0)
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

    def __init__(self, mesh: Mesh, fabric: Fabric, positions: Floats) -> None:
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
        # Setting a state lets go of all that was held before.
        self._solver.set_state(self.positions(), self.velocities(), self._solver.memory())
        self._solver.pin(self._held)

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
        if not self._solver.carry(self._held, paths):
            raise SimulationError("the sample diverged while it was carried; carry it more slowly, and report it")

    def _place(self, positions: Floats) -> None:
        self._solver.set_state(np.asarray(positions, float), np.zeros((len(positions), 3)), {})


def simulator(**params: Any) -> Any:
    """The simulator that agents fold in, with these parameters; the cloth's fabric comes with the garment."""
    return plugins.create("simulators", "xpbd", params)


def garment(kind: str, seed: int, edge_length: float, fabric: Fabric) -> Garment:
    """A seeded garment of a kind, meshed at about ``edge_length`` [m], of this fabric."""
    return replace(plugins.generate_garment(kind, seed, edge_length), fabric=fabric)
