"""The cloth's moving state and the stages of a fold around the compiled loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Fabric, Mesh
from polyfold.geometry import Camera
from polyfold.types import Action
from polyfold_xpbd.grasp import plan_motion, take_hold
from polyfold_xpbd.kernels.loop import DIVERGED, SETTLED, advance
from polyfold_xpbd.kernels.vectors import vertex_normals
from polyfold_xpbd.model import ClothModel, build_model
from polyfold_xpbd.tethers import TetherMap

DISC_RADIUS = 0.7
"""Radius of a contact disc in edge lengths; above 0.58 discs leave no gap in an even mesh."""
PAD = 0.25
"""How far ahead the list of near pairs looks, in edge lengths."""
PAIRS_PER_PARTICLE = 64
"""Room in the list of near pairs. Flat stacks have about 10 however high they are; more than this is a blow-up."""
RELAXATION, LARGEST_PUSH = 0.3, 0.2
"""Share of an overlap resolved per substep, and the most of it in thicknesses."""
RECOVERY = 0.1
"""Speed at which overlapping layers come apart [m/s]."""
TOP_SPEED = 5.0
"""Particles are never faster than this [m/s]."""
MOVING, SETTLING = 8.0, 20.0
"""Velocity damping while a gripper moves and while the cloth comes to rest [1/s]."""
REST_SPEED, LONGEST_SETTLING = 0.003, 1.5
"""RMS speed that counts as rest [m/s], and how long to wait for it [s]."""


def time_step(edge_length: float) -> float:
    """Substep [s] that a mesh of this edge length [m] needs."""
    return 1 / 900 if edge_length < 0.0128 else 1 / 600


@lru_cache(maxsize=4)
def _constraints(mesh: Mesh, bending_length: float) -> tuple[ClothModel, TetherMap]:
    """What a mesh is held together by; studies lay the same few garments again and again."""
    return build_model(mesh, bending_length), TetherMap(mesh)


class Solver:
    """One cloth: buffers of the compiled loop, and folding, settling and waiting with them."""

    def __init__(self, mesh: Mesh, flat: NDArray[np.float64], fabric: Fabric) -> None:
        count = len(flat)
        self._model, self._tethers = _constraints(mesh, fabric.bending_length)
        self._thickness = fabric.thickness
        edge_length = self._model.edge_length
        self.dt = time_step(edge_length)
        radius = DISC_RADIUS * edge_length
        self._settings = np.array(
            [
                self.dt, radius, fabric.thickness, PAD * edge_length, fabric.table_friction, fabric.cloth_friction,
                RELAXATION, LARGEST_PUSH * fabric.thickness, fabric.thickness / 2, TOP_SPEED,
                RECOVERY * self.dt,
            ],
            np.float32,
        )  # fmt: skip
        self.x = np.empty((count, 3), np.float32)
        self.x[:, :2] = flat
        self.x[:, 2] = fabric.thickness / 2 + fabric.thickness * mesh.layer
        self.x[mesh.seam, 2] = fabric.thickness
        self.v = np.zeros((count, 3), np.float32)
        self._previous, self._listed = self.x.copy(), self.x.copy()
        self._normals = np.zeros((count, 3), np.float32)
        self._mobility = np.ones(count, np.float32)
        self._start, self._old_start = np.zeros(count + 1, np.int32), np.zeros(count + 1, np.int32)
        capacity = PAIRS_PER_PARTICLE * count
        self._second, self._old_second = np.zeros(capacity, np.uint32), np.zeros(capacity, np.uint32)
        self._side, self._old_side = np.zeros((capacity, 2), np.int8), np.zeros((capacity, 2), np.int8)
        self._pair_normal = np.zeros((capacity, 3), np.float32)
        self._clock = np.zeros(3, np.int64)
        self._supported, self._rests = np.zeros(count, np.bool_), np.zeros(count, np.bool_)

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Vertex indices, shape (T, 3)."""
        return self._model.normal_corners

    def positions(self) -> NDArray[np.float64]:
        """Particle positions [m], shape (N, 3)."""
        return self.x.astype(np.float64)

    def velocities(self) -> NDArray[np.float64]:
        """Particle velocities [m/s], shape (N, 3)."""
        return self.v.astype(np.float64)

    def surface_normals(self) -> NDArray[np.float32]:
        """Unit normals of the particles, shape (N, 3)."""
        vertex_normals(self.x, self._model.normal_corners, self._model.normal_use, self._normals)
        return self._normals

    def contact_memory(self) -> dict[str, NDArray[Any]]:
        """On which side of each other near particles belong.

        Those near particle i are ``pair_second[pair_start[i]:pair_start[i + 1]]``, shapes (P,) and (N + 1,);
        ``pair_side``, shape (P, 2), says on which side of i they are, and i of them: -1, 0 (not known yet) or 1.
        """
        count = self._start[-1]
        return {
            "pair_start": self._start.copy(),
            "pair_second": self._second[:count].copy(),
            "pair_side": self._side[:count].copy(),
        }

    def set_state(
        self, positions: NDArray[np.float64], velocities: NDArray[np.float64], memory: Mapping[str, Any]
    ) -> None:
        """Return to an earlier state.

        Args:
            positions: of the particles [m], shape (N, 3).
            velocities: of the particles [m/s], shape (N, 3).
            memory: what :meth:`contact_memory` gave then; without it, sides are taken from the geometry.
        """
        self.x[:] = positions
        self.v[:] = velocities
        self._start[:] = memory.get("pair_start", 0)
        count = int(self._start[-1])
        self._second[:count] = memory.get("pair_second", 0)
        self._side[:count] = memory.get("pair_side", 0)
        self._mobility[:] = 1.0

    def fold(self, action: Action, camera: Camera, on_frame: Callable[[], None] | None, interval: float) -> bool:
        """Move what the picks hold to the places and let it come to rest. False if it diverged."""
        grasp = take_hold(action, self.positions(), camera, self._thickness)
        if grasp is None:
            return True
        motion = plan_motion(grasp, self.dt)
        self._mobility[grasp.particles] = 0.0
        held = (grasp.particles, grasp.offsets, grasp.arms, motion.directions, motion.path, motion.angles)
        held += self._tethers.tie(grasp.particles, grasp.arms, grasp.offsets)
        alive = self._run(held, len(motion.path), MOVING, 0.0, on_frame, interval)
        self._mobility[:] = 1.0
        return alive and self.settle(LONGEST_SETTLING, on_frame, interval)

    def settle(self, longest: float, on_frame: Callable[[], None] | None = None, interval: float = 0.0) -> bool:
        """Let the cloth come to rest for at most ``longest`` seconds. False if it diverged."""
        alive = self._run(_EMPTY, round(longest / self.dt), SETTLING, REST_SPEED, on_frame, interval)
        self.v[:] = 0.0
        return alive

    def wait(self, seconds: float, on_frame: Callable[[], None] | None = None, interval: float = 0.0) -> bool:
        """Let time pass. False if it diverged."""
        alive = self._run(_EMPTY, round(seconds / self.dt), SETTLING, 0.0, on_frame, interval)
        self.v[:] = 0.0
        return alive

    def _run(
        self,
        held: tuple[NDArray[Any], ...],
        substeps: int,
        damping: float,
        rest_speed: float,
        on_frame: Callable[[], None] | None,
        interval: float,
    ) -> bool:
        # A fresh list and clock make a stage depend on the saved state alone, so that restore() repeats exactly.
        self._clock[:], self._supported[:], self._rests[:] = 0, False, False
        chunk = substeps if on_frame is None else max(1, round(interval / self.dt))
        done = 0
        while done < substeps:
            status, done = self._advance(held, done, min(done + chunk, substeps), damping, rest_speed)
            if status == DIVERGED:
                return False
            if on_frame is not None:
                on_frame()
            if status == SETTLED:
                break
        return True

    def _advance(
        self, held: tuple[NDArray[Any], ...], first: int, last: int, damping: float, rest_speed: float
    ) -> tuple[int, int]:
        model = self._model
        return advance(
            self.x, self.v, self._previous, self._listed, self._mobility, self._normals, model.edges,
            model.rest_lengths, model.hinges, model.hinge_weights, model.normal_corners, model.normal_use,
            model.excluded_start, model.excluded, self._start, self._second, self._side, self._pair_normal,
            self._old_start, self._old_second, self._old_side, self._clock, self._supported, self._rests, *held,
            first, last, self._settings, np.float32(damping), np.float32(rest_speed),
        )  # fmt: skip


_EMPTY = (
    np.zeros(0, np.uint32),
    np.zeros((0, 3), np.float32),
    np.zeros(0, np.uint32),
    np.zeros((1, 2), np.float32),
    np.zeros((1, 1, 3), np.float32),
    np.zeros(1, np.float32),
    np.zeros(0, np.uint32),
    np.zeros(0, np.uint32),
    np.zeros(0, np.float32),
)
