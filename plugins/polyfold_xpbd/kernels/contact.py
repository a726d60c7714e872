"""Contact: of the cloth with itself, and with the table.

Self-contact is that of oriented discs: a particle keeps others at one thickness along their common normal.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled, shift

UPPER_SHARE = 0.85
"""Share of a push that the upper of two layers takes when the lower one lies on the table."""


@compiled
def resolve_pairs(
    x, previous, mobility, supported, rests, start, pj, pair_normal,
    radius, thickness, friction, relaxation, cap, recovery,
):  # fmt: skip
    """Push overlapping discs apart and hold them by Coulomb friction.

    A push changes velocities only as far as it stops an approach and opens the overlap by ``recovery`` per substep; the
    rest moves ``previous`` along, so that resolving an overlap never throws cloth into the air. ``supported`` is what
    rested on the table, directly or on others, in the substep before; ``rests`` gathers it for the next.
    """
    radius_2 = radius * radius
    zero, half = np.float32(0.0), np.float32(0.5)
    upper_share, upright = np.float32(UPPER_SHARE), np.float32(0.7)
    for i in range(start.shape[0] - 1):
        for p in range(start[i], start[i + 1]):
            j = pj[p]
            nx, ny, nz = pair_normal[p, 0], pair_normal[p, 1], pair_normal[p, 2]
            dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
            along = nx * dx + ny * dy + nz * dz
            if along >= thickness:
                continue
            d2 = dx * dx + dy * dy + dz * dz
            if nx == zero and ny == zero and nz == zero:
                if d2 >= thickness * thickness or d2 < np.float32(1e-12):
                    continue
                along = np.sqrt(d2)
                nx, ny, nz = dx / along, dy / along, dz / along
            elif d2 - along * along > radius_2:
                continue
            if mobility[i] + mobility[j] == zero:
                continue
            # What lies on the table can't give way downwards; sharing pushes evenly would let a stack sink into itself.
            share_j = half
            if nz > upright and supported[i]:
                share_j, rests[j] = upper_share, True
            elif nz < -upright and supported[j]:
                share_j, rests[i] = np.float32(1.0) - upper_share, True
            if mobility[i] * mobility[j] == zero:
                share_j = mobility[j]
            share_i = np.float32(1.0) - share_j
            push = min(relaxation * (thickness - along), cap)
            mx = (x[j, 0] - previous[j, 0]) - (x[i, 0] - previous[i, 0])
            my = (x[j, 1] - previous[j, 1]) - (x[i, 1] - previous[i, 1])
            mz = (x[j, 2] - previous[j, 2]) - (x[i, 2] - previous[i, 2])
            opening = nx * mx + ny * my + nz * mz
            tx, ty, tz = mx - opening * nx, my - opening * ny, mz - opening * nz
            slip = np.sqrt(tx * tx + ty * ty + tz * tz) + np.float32(1e-12)
            hold = min(np.float32(1.0), friction * push / slip)
            silent = push - min(push, max(-opening, zero) + recovery)
            px, py, pz = push * nx - hold * tx, push * ny - hold * ty, push * nz - hold * tz
            shift(x, j, share_j, px, py, pz)
            shift(x, i, -share_i, px, py, pz)
            shift(previous, j, share_j * silent, nx, ny, nz)
            shift(previous, i, -share_i * silent, nx, ny, nz)


@compiled
def table(x, previous, mobility, supported, rests, floor, friction):
    """Lift particles onto the table and hold them by Coulomb friction.

    Args:
        x, previous: positions [m], shape (N, 3), now and before the substep, changed.
        mobility: 0 for held particles and 1 for free ones, shape (N,).
        supported: gets what rests on the table, directly or on others, shape (N,).
        rests: what contacts found to rest on others, shape (N,); cleared.
        floor: lowest height of a particle [m].
        friction: coefficient.
    """
    for i in range(x.shape[0]):
        push = floor - x[i, 2]
        supported[i] = rests[i] or push > np.float32(0.0)
        rests[i] = False
        if push > np.float32(0.0) and mobility[i] > np.float32(0.0):
            x[i, 2] = floor
            previous[i, 2] = max(previous[i, 2], floor)
            tx, ty = x[i, 0] - previous[i, 0], x[i, 1] - previous[i, 1]
            slip = np.sqrt(tx * tx + ty * ty) + np.float32(1e-12)
            hold = min(np.float32(1.0), friction * push / slip)
            x[i, 0] -= hold * tx
            x[i, 1] -= hold * ty
