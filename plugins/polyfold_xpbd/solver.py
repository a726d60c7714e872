"""The cloth's moving state and the stages of a fold around the compiled loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Fabric, Mesh
from polyfold.geometry import Camera
from polyfold.types import Action
from polyfold_xpbd.ahead.calling import ahead
from polyfold_xpbd.giving import ALL, borne, give_way
from polyfold_xpbd.grasp import Grasp, plan_motion, take_hold
from polyfold_xpbd.kernels.guarantee.close import watch_memory
from polyfold_xpbd.kernels.loop import DIVERGED, SETTLED, advance
from polyfold_xpbd.kernels.vectors import vertex_normals
from polyfold_xpbd.model import ClothModel, build_model
from polyfold_xpbd.stability import bending_lead, bent_normal, time_step
from polyfold_xpbd.tethers import TetherMap, Tethers

average_normals = ahead("average_normals", vertex_normals)

SLACK = 0.002
"""How far particles may stray from where they were foreseen before near pairs are listed again [m]."""
PAIRS_PER_PARTICLE = 96
"""Room in the list of near pairs. Flat stacks have about 8 however high they are.

Where there is no room, the list looks less far ahead.
"""
RECOVERY = 0.03
"""Speed at which overlapping plies come apart [m/s]."""
TOP_SPEED = 5.0
"""Particles are never faster than this [m/s]."""
MOVING, SETTLING = 8.0, 60.0
"""Velocity damping while a gripper moves and while the cloth comes to rest [1/s]."""
REST_SPEED, LONGEST_SETTLING = 0.003, 1.0
"""RMS speed that counts as rest [m/s], and how long to wait for it [s]."""


@lru_cache(maxsize=4)
def _constraints(mesh: Mesh, fabric: Fabric) -> tuple[ClothModel, TetherMap]:
    """What a mesh is held together by; studies lay the same few garments again and again."""
    return build_model(mesh, fabric), TetherMap(mesh)


class Grip(NamedTuple):
    """What the grippers hold, where they take it, and the tethers that this puts on the cloth."""

    grasp: Grasp
    tethers: Tethers


class Solver:
    """One cloth: buffers of the compiled loop, and folding, settling and waiting with them.

    Attributes:
        slipped: of what each arm held in the last fold, the share that slipped out of its grip.
        short: how far from its place each arm stood at the end of the last fold [m].
    """

    def __init__(self, mesh: Mesh, flat: NDArray[np.float64], fabric: Fabric, guaranteed: bool = False) -> None:
        count = len(flat)
        self._model, self._tethers = _constraints(mesh, fabric)
        self._thickness = fabric.thickness
        edge_length = self._model.edge_length
        self.dt = time_step(edge_length, self._model.bending_rate)
        self._settings = np.array(
            [
                self.dt, fabric.thickness, SLACK, edge_length, fabric.table_friction, fabric.cloth_friction,
                RECOVERY * self.dt, TOP_SPEED, fabric.crease_set,
                bending_lead(self.dt, self._model.bending_rate), bent_normal(fabric.thickness / edge_length),
            ],
            np.float32,
        )  # fmt: skip
        self.x = np.empty((count, 3), np.float32)
        self.x[:, :2] = flat
        self.x[:, 2] = fabric.thickness / 2 + fabric.thickness * mesh.layer
        self.x[mesh.seam, 2] = fabric.thickness
        self.v = np.zeros((count, 3), np.float32)
        self._previous, self._listed, self._foreseen = self.x.copy(), self.x.copy(), self.v.copy()
        self._start, self._rested = self.x.copy(), self.x.copy()
        self._normals = np.zeros((count, 3), np.float32)
        self._mobility = self._model.lightness.copy()
        edges, hinges = len(self._model.edges), len(self._model.hinges)
        self._sharp = np.zeros(edges, np.bool_)
        self._stray, self._order = np.zeros(count, np.int32), np.zeros(count, np.int32)
        self._again = np.zeros(count, np.bool_), np.zeros(edges, np.bool_), np.zeros(count, np.bool_)
        self._vertex_range = np.zeros(count, np.int32), np.zeros(count, np.int32)
        self._edge_range = np.zeros(edges, np.int32), np.zeros(edges, np.int32)
        room = PAIRS_PER_PARTICLE * count
        self._first, self._moved = np.zeros(room, np.int32), np.zeros(room, np.int32)
        self._pairs, self._old_pairs = _pair_memory(room), _pair_memory(room)
        self._contacts = (
            np.zeros((room, 4), np.int32), np.zeros((room, 4), np.float32),
            np.zeros((room, 4), np.float32), np.zeros((room, 3), np.float32),
            np.zeros(room, np.float32), np.zeros(room, np.int32),
        )  # fmt: skip
        self._table_load = np.zeros((count, 3), np.float32)
        self._set = np.zeros(hinges, np.float32)
        self._rest = np.zeros((hinges, 3), np.float32)
        self._clock = np.zeros(6, np.int64)
        self.slipped: tuple[float, ...] = ()
        self.short: tuple[float, ...] = ()
        self._watch = watch_memory(count) if guaranteed else None

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
        average_normals(self.x, self._model.normal_corners, self._model.normal_use, self._normals)
        return self._normals

    def memory(self) -> dict[str, NDArray[Any]]:
        """What the cloth remembers beside where it is: contacts with their sides, and creases.

        Pair k is of ``pair_first[k]`` and ``pair_second[k]``, shape (P,); the first ``pair_kinds[0]`` are of a vertex
        and a triangle, the others of two edges; ``pair_side[k]`` says on which side of each other they are, and
        ``pair_over[k]`` whether they were over each other. ``crease`` and ``crease_rest``, shapes (H,) and (H, 3), are
        the set curvatures of the hinges.
        """
        vertex_pairs, pairs = int(self._clock[2]), int(self._clock[3])
        second, side, over, _ = self._pairs
        return {
            "pair_kinds": np.array([vertex_pairs, pairs - vertex_pairs]),
            "pair_first": self._first[:pairs].copy(),
            "pair_second": second[:pairs].copy(),
            "pair_side": side[:pairs].copy(),
            "pair_over": over[:pairs].copy(),
            "crease": self._set.copy(),
            "crease_rest": self._rest.copy(),
        }

    def set_state(
        self, positions: NDArray[np.float64], velocities: NDArray[np.float64], memory: Mapping[str, Any]
    ) -> None:
        """Return to an earlier state.

        Args:
            positions: of the particles [m], shape (N, 3).
            velocities: of the particles [m/s], shape (N, 3).
            memory: what :meth:`memory` gave then; without it, sides are taken from the geometry and creases forgotten.
        """
        self.x[:] = positions
        self.v[:] = velocities
        vertex_pairs, edge_pairs = (int(n) for n in memory.get("pair_kinds", (0, 0)))
        pairs = vertex_pairs + edge_pairs
        second, side, over, _ = self._pairs
        self._first[:pairs] = memory.get("pair_first", 0)
        second[:pairs] = memory.get("pair_second", 0)
        side[:pairs], over[:pairs] = memory.get("pair_side", 0), memory.get("pair_over", 0)
        for (starts, stops), begin, end in (
            (self._vertex_range, 0, vertex_pairs), (self._edge_range, vertex_pairs, pairs),
        ):  # fmt: skip
            starts[:], stops[:] = 0, 0
            owners, at, counts = np.unique(self._first[begin:end], return_index=True, return_counts=True)
            starts[owners], stops[owners] = begin + at, begin + at + counts
        self._clock[2], self._clock[3] = vertex_pairs, pairs
        self._set[:], self._rest[:] = memory.get("crease", 0.0), memory.get("crease_rest", 0.0)
        self._mobility[:] = self._model.lightness

    def pin(self, particles: NDArray[np.int64]) -> None:
        """Hold particles, indices of shape (K,), where they are until another state is set."""
        self._mobility[particles] = 0.0

    def grip(self, action: Action, camera: Camera, strain: float) -> Grip | None:
        """What the grippers would hold, and how far it lets them go; None if there is no cloth under any pick.

        Args:
            action: picks and places [px].
            camera: which point of the table a pixel is.
            strain: share by which cloth between two arms may be longer than at rest.
        """
        grasp = take_hold(action, self.positions(), self.triangles, camera, self._thickness, self._model.longest_edge)
        if grasp is None:
            return None
        tethers = self._tethers.tie(grasp.particles, grasp.arms, grasp.offsets)
        return Grip(give_way(grasp, tethers, strain), tethers)

    def fold(self, grip: Grip, on_frame: Callable[[], None] | None, interval: float) -> bool:
        """Move what the grippers hold to the places and let it come to rest. False if it diverged."""
        grasp, tethers = grip
        motion = plan_motion(grasp, self.dt)
        self._mobility[grasp.particles] = 0.0
        held = (grasp.particles, grasp.offsets, grasp.arms, motion.directions, motion.path, motion.turns)
        held += tethers
        first, second = self.x[self._model.edges.T]
        bears = borne(np.linalg.norm(second - first, axis=1) / self._model.rest_lengths - 1.0)
        alive = self._run(held, len(motion.path), MOVING, 0.0, on_frame, interval, bears)
        stood = motion.path[-1 - int(self._clock[5])]
        self.short = tuple((grasp.short + np.linalg.norm(motion.path[-1] - stood, axis=1)).round(4).tolist())
        arms, free = len(grasp.ends), self._mobility[grasp.particles] > 0.0
        lost, taken = np.bincount(grasp.arms, free, arms), np.bincount(grasp.arms, minlength=arms)
        self.slipped = tuple((lost / np.maximum(taken, 1)).round(2).tolist())
        self._mobility[:] = self._model.lightness
        return alive and self.settle(LONGEST_SETTLING, on_frame, interval)

    def carry(self, particles: NDArray[np.int64], paths: NDArray[np.float64]) -> bool:
        """Move pinned particles, indices of shape (K,), and let time pass. False if the cloth diverged.

        Args:
            particles: what :meth:`pin` holds.
            paths: where each is after every substep [m], shape (substeps, K, 3).
        """
        held, arms = particles.astype(np.uint32), np.arange(len(particles), dtype=np.uint32)
        offsets, directions = np.zeros((len(held), 3), np.float32), np.zeros((len(held), 2), np.float32)
        unturned = np.tile(np.array([1.0, 0.0], np.float32), (len(paths), 1))
        motion = (held, offsets, arms, directions, paths.astype(np.float32), unturned)
        return self._run(motion + self._tethers.tie(held, arms, offsets), len(paths), MOVING, 0.0, None, 0.0)

    def settle(self, longest: float, on_frame: Callable[[], None] | None = None, interval: float = 0.0) -> bool:
        """Let the cloth come to rest for at most ``longest`` seconds. False if it diverged."""
        alive = self._run(NOTHING_HELD, round(longest / self.dt), SETTLING, REST_SPEED, on_frame, interval)
        self.v[:] = 0.0
        return alive

    def wait(self, seconds: float, on_frame: Callable[[], None] | None = None, interval: float = 0.0) -> bool:
        """Let time pass. False if it diverged."""
        alive = self._run(NOTHING_HELD, round(seconds / self.dt), SETTLING, 0.0, on_frame, interval)
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
        bears: NDArray[np.float32] = ALL,
    ) -> bool:
        # A fresh list and no loads make a stage depend on the saved state alone, so that restore() repeats exactly.
        self._clock[:2], self._clock[5] = (0, -1), 0
        if self._watch is not None:
            self._watch.counts[:] = 0
        self._pairs[3][: self._clock[3]], self._table_load[:], self._sharp[:] = 0.0, 0.0, False
        chunk = substeps if on_frame is None else max(1, round(interval / self.dt))
        done = 0
        while done < substeps:
            status, done = self._advance(held, done, min(done + chunk, substeps), damping, rest_speed, bears)
            if status == DIVERGED:
                return False
            if on_frame is not None:
                on_frame()
            if status == SETTLED:
                break
        return True

    def _advance(
        self,
        held: tuple[NDArray[Any], ...],
        first: int,
        last: int,
        damping: float,
        rest_speed: float,
        bears: NDArray[np.float32] = ALL,
    ) -> tuple[int, int]:
        model = self._model
        return advance(
            self.x, self.v, self._previous, self._start, self._mobility, self._normals, model.edges, model.rest_lengths,
            model.hinges, model.hinge_weights, model.elastic, self._set, self._rest, model.normal_corners, model.panel,
            model.normal_use, self._clock, self._listed, self._foreseen, self._rested, self._sharp, self._stray,
            self._order, *self._again, self._moved, *self._vertex_range, *self._edge_range, self._first, *self._pairs,
            *self._old_pairs, *self._contacts, self._table_load, *held, model.lightness, bears,
            None if self._watch is None else tuple(self._watch),
            first, last, self._settings, np.float32(damping), np.float32(rest_speed),
        )  # fmt: skip


def _pair_memory(room: int) -> tuple[NDArray[Any], ...]:
    """Second members, sides, whether one is over the other, and loads of pairs."""
    return np.zeros(room, np.int32), np.zeros(room, np.int8), np.zeros(room, np.int8), np.zeros((room, 4), np.float32)


NOTHING_HELD = (
    np.zeros(0, np.uint32),
    np.zeros((0, 3), np.float32),
    np.zeros(0, np.uint32),
    np.zeros((1, 2), np.float32),
    np.zeros((1, 1, 3), np.float32),
    np.zeros((1, 2), np.float32),
    np.zeros(0, np.uint32),
    np.zeros(0, np.uint32),
    np.zeros(0, np.float32),
)
"""What the compiled loop is told of grippers where there are none: :meth:`Solver.fold` has the order."""
