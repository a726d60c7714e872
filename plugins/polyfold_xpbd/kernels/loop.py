"""The loop over substeps, the one kernel that the solver calls."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit

from polyfold_xpbd.kernels.contact import resolve, table, warm_start
from polyfold_xpbd.kernels.motion import carry, damp, is_finite, predict, rests, strays, velocities
from polyfold_xpbd.kernels.pairs import list_edge_pairs, list_vertex_pairs, mark_sharp
from polyfold_xpbd.kernels.sheet import bend, crease, hold_back, stretch
from polyfold_xpbd.kernels.touching import find_edge_contacts, find_vertex_contacts
from polyfold_xpbd.kernels.vectors import vertex_normals

RUNNING, SETTLED, DIVERGED = 0, 1, 2
LOOK_EVERY = 8
"""Substeps between looks at which listed pairs touch, where and which way."""
HORIZON = 16
"""Substeps for which a list of pairs looks ahead."""
REST_OVER = 40
"""Substeps over which the cloth is watched for rest."""


def _digest() -> str:
    """SHA-256 of the kernels' sources."""
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()


def _kept_under(digest: str) -> Callable[..., tuple[int, int]]:
    """The loop, whose machine code is kept on disk under a digest: numba's key holds what a function closes over."""

    @njit(cache=True, error_model="numpy")
    def advance(
        x, v, previous, start, mobility, normals, edges, rest_lengths, hinges, hinge_weights, elastic, set_curvature,
        rest, corners, panel, use, clock, listed, foreseen, rested, sharp, vertex_starts, vertex_stops, edge_starts,
        edge_stops, first, second, side, over, load, old_second, old_side, old_over, old_load, bodies, weights,
        responses, contact_normals, inverse, source, table_load, grasped, offsets, arm, directions, path, turns, tied,
        anchors, lengths, begin, end, settings, damping, rest_speed,
    ):  # fmt: skip
        """Run substeps ``begin`` to ``end`` in place; stop once the cloth is slower than ``rest_speed`` [m/s], if > 0.

        Args (beyond the model's arrays and the state's buffers):
            clock: substeps since the stage began and since the list of pairs was made, its vertex pairs, all its pairs
                and the contacts in use, int64, shape (5,).
            settings: time step [s], thickness, slack and cell [m], friction of table and cloth, recovery [m] and top
                speed [m/s], share of a crease that stays, lead of bending [s], mean normal of a bend, shape (11,).

        Returns:
            (status, substeps done).
        """
        digest  # noqa: B018  # pyright: ignore[reportUnusedExpression]  (closed over, for numba's key)
        dt, thickness, slack, cell = settings[0], settings[1], settings[2], settings[3]
        table_friction, cloth_friction, recovery, fastest = settings[4], settings[5], settings[6], settings[7]
        inverse_dt = np.float32(1.0) / dt
        floor = np.float32(0.5) * thickness
        horizon, window = np.float32(HORIZON) * dt, np.float32(LOOK_EVERY) * dt
        zero, crowded = np.float32(0.0), False
        for k in range(begin, end):
            # Looked ahead before bending acts: contacts take back most of what it adds, which is no travel to foresee.
            if (
                clock[1] < 0
                or clock[1] >= HORIZON
                or strays(x, listed, foreseen, np.float32(clock[1]) * dt, np.float32(0.5) * slack)
            ):
                if not is_finite(x):
                    return DIVERGED, k
                vertex_normals(x, corners, use, normals)
                mark_sharp(normals, edges, sharp, settings[10])
                count = clock[3]
                old_second[:count], old_side[:count] = second[:count], side[:count]
                old_over[:count], old_load[:count] = over[:count], load[:count]
                clock[1] = 0
                # What flies wildly comes near everything in that time: then there is room for what is near now, and
                # the next substep lists anew.
                for ahead in (horizon, zero):
                    clock[2] = list_vertex_pairs(
                        x, v, normals, ahead, thickness + slack, cell, corners, thickness, vertex_starts, vertex_stops,
                        old_second, old_side, old_over, old_load, first, second, side, over, load,
                    )  # fmt: skip
                    crowded = ahead == zero
                    if clock[2] >= 0:
                        break
                if clock[2] < 0:
                    return DIVERGED, k
                for ahead in (horizon, zero):
                    clock[3] = list_edge_pairs(
                        x, v, ahead, thickness + slack, cell, edges, sharp, edge_starts, edge_stops, clock[2],
                        old_second, old_side, old_over, old_load, first, second, side, over, load,
                    )  # fmt: skip
                    crowded = crowded or ahead == zero
                    if clock[3] >= 0:
                        break
                if clock[3] < 0:
                    return DIVERGED, k
                listed[:, :], foreseen[:, :] = x, v
            if clock[1] % LOOK_EVERY == 0:
                crease(x, hinges, hinge_weights, elastic, settings[8], set_curvature, rest)
                found = find_vertex_contacts(
                    x, v, window, mobility, corners, panel, thickness, clock[2], first, second, side, over, load,
                    bodies, weights, responses, contact_normals, inverse, source,
                )  # fmt: skip
                clock[4] = find_edge_contacts(
                    x, v, window, mobility, edges, thickness, clock[2], clock[3], found, first, second, side, over,
                    load, bodies, weights, responses, contact_normals, inverse, source,
                )  # fmt: skip
            damp(v, dt, damping)
            bend(x, v, previous, hinges, hinge_weights, rest, settings[9], dt)
            clock[0] += 1
            clock[1] = HORIZON if crowded else clock[1] + 1
            predict(x, v, previous, start, mobility, dt, fastest)
            if grasped.shape[0] > 0:
                carry(x, grasped, offsets, arm, directions, path, turns, k)
            fall = np.float32(9.81) * dt * dt
            warm_start(x, mobility, clock[4], bodies, responses, contact_normals, source, load, table_load, fall)
            if grasped.shape[0] > 0:
                hold_back(x, mobility, tied, anchors, lengths)
            stretch(x, mobility, edges, rest_lengths)
            resolve(
                x, previous, clock[4], bodies, weights, responses, contact_normals, inverse, source, load, thickness,
                cloth_friction, recovery,
            )  # fmt: skip
            table(x, previous, mobility, table_load, floor, table_friction)
            velocities(x, previous, start, v, inverse_dt)
            if rest_speed > 0 and clock[0] % REST_OVER == 0:
                slow = rests(x, rested, np.float32(REST_OVER) * dt * rest_speed)
                if slow and clock[0] > REST_OVER:
                    return SETTLED, k + 1
        return (RUNNING if is_finite(x) else DIVERGED), end

    return advance


advance = _kept_under(_digest())
