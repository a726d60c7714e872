"""The loop over substeps, the one kernel that the solver calls."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit

from polyfold_xpbd.kernels.contact import resolve_pairs, table
from polyfold_xpbd.kernels.motion import carry, is_finite, predict, velocities
from polyfold_xpbd.kernels.pairs import mark_moved, pair_normals, update_pairs
from polyfold_xpbd.kernels.sheet import bend, hold_back, stretch
from polyfold_xpbd.kernels.vectors import vertex_normals

RUNNING, SETTLED, DIVERGED = 0, 1, 2
LOOK_EVERY = 5
"""Substeps between looks at who is near whom and which way the sheet faces."""
LOOK_AFTER = 0.8
"""Look earlier once the fastest particle may have come this far, in pads."""
BEND_EVERY = 2
"""Substeps per bending step: bending is slow against stretching, and stable far beyond this."""


def _digest() -> str:
    """SHA-256 of the kernels' sources."""
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()


def _kept_under(digest: str) -> Callable[..., tuple[int, int]]:
    """The loop, whose machine code is kept on disk under a digest: numba's key holds what a function closes over."""

    @njit(cache=True, error_model="numpy")
    def advance(
        x, v, previous, listed, mobility, normals, edges, rest_lengths, hinges, hinge_weights, corners, use,
        excluded_start, excluded, start, pj, side, pair_normal, old_start, old_j, old_side, clock, supported, rests,
        grasped, offsets, arm, directions, path, angles, tied, anchors, lengths, first, last, settings, damping,
        rest_speed,
    ):  # fmt: skip
        """Run substeps ``first`` to ``last`` in place; stop once slow (``rest_speed`` > 0) for ten substeps.

        Args (beyond the model's arrays and the state's buffers):
            clock: substeps since the stage began, for how many the cloth has been slow, and how far the fastest
                particle may have come since the last look [nm], int64, shape (3,).
            settings: time step [s], radius, thickness and pad [m], friction of table and cloth, relaxation, cap and
                floor [m], top speed [m/s], recovery [m], float32, shape (11,).

        Returns:
            (status, substeps done).
        """
        digest  # noqa: B018  # pyright: ignore[reportUnusedExpression]  (closed over, for numba's key)
        dt, radius, thickness, pad = settings[0], settings[1], settings[2], settings[3]
        table_friction, cloth_friction, relaxation, cap = settings[4], settings[5], settings[6], settings[7]
        floor, fastest = settings[8], settings[9]
        inverse_dt = np.float32(1.0) / dt
        moved = np.empty(x.shape[0], np.bool_)
        for k in range(first, last):
            if clock[0] % BEND_EVERY == 0:
                bend(x, v, hinges, hinge_weights, np.float32(BEND_EVERY) * dt)
            predict(x, v, previous, mobility, dt, damping, fastest)
            if grasped.shape[0] > 0:
                carry(x, grasped, offsets, arm, directions, path, angles, k)
                hold_back(x, mobility, tied, anchors, lengths)
            stretch(x, mobility, edges, rest_lengths)
            if clock[0] % LOOK_EVERY == 0 or clock[2] > LOOK_AFTER * pad * 1e9:
                clock[2] = 0
                if not is_finite(x):
                    return DIVERGED, k
                vertex_normals(x, corners, use, normals)
                if mark_moved(x, listed, moved, np.float32(0.3) * pad, clock[0] == 0):
                    count = start[-1]
                    old_start[:] = start
                    old_j[:count] = pj[:count]
                    old_side[:count, :] = side[:count, :]
                    found = update_pairs(
                        x, normals, moved, excluded_start, excluded, radius, thickness, pad,
                        old_start, old_j, old_side, start, pj, side,
                    )  # fmt: skip
                    if found < 0:
                        return DIVERGED, k
                pair_normals(normals, start, pj, side, pair_normal)
            clock[0] += 1
            resolve_pairs(
                x, previous, mobility, supported, rests, start, pj, pair_normal,
                radius, thickness, cloth_friction, relaxation, cap, settings[10],
            )  # fmt: skip
            table(x, previous, mobility, supported, rests, floor, table_friction)
            energy, fastest_2 = velocities(x, previous, v, inverse_dt)
            clock[2] += int(np.sqrt(fastest_2) * dt * np.float32(1e9))
            if rest_speed > 0:
                clock[1] = clock[1] + 1 if energy < x.shape[0] * rest_speed * rest_speed else 0
                if clock[1] >= 10:
                    return SETTLED, k + 1
        return (RUNNING if is_finite(x) else DIVERGED), last

    return advance


advance = _kept_under(_digest())
