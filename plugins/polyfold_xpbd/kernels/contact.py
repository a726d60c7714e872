"""Contact: of the cloth with itself, and with the table.

Pushes and friction are accumulated per pair over substeps and applied again at the start of the next (warm starting),
so that a stack at rest carries itself and the sweep finds nothing to do. The sweep goes up and down again: one way
alone, plies of thick packets circle on each other without end.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled, shift

KEPT_FRICTION, MOST = 0.9, 30.0
"""Share of friction that the next substep starts with: kept whole, it is a spring without a damper.

And the most of a push, in what gravity moves a particle by in a substep. Where folds ask for the impossible, pushes
that were kept whole would grow without end.
"""
RECOVERY = 0.1
"""Share of an overlap that a substep opens."""


@compiled
def warm_start(x, mobility, count, bodies, responses, normals, source, load, table_load, fall):
    """Apply most of what contacts and the table carried in the substep before.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        count, bodies, responses, normals, source: the contacts, see :mod:`polyfold_xpbd.kernels.touching`.
        load, table_load: pushes and friction [m] per pair, shape (P, 4), and per particle, shape (N, 3), changed.
        fall: what gravity moves a particle by in a substep [m].
    """
    most = np.float32(MOST) * fall
    for i in range(x.shape[0]):
        if table_load[i, 0] != np.float32(0.0):
            if mobility[i] == np.float32(0.0):
                table_load[i, :] = np.float32(0.0)
                continue
            table_load[i, 1] *= np.float32(KEPT_FRICTION)
            table_load[i, 2] *= np.float32(KEPT_FRICTION)
            x[i, 0] += table_load[i, 1]
            x[i, 1] += table_load[i, 2]
            x[i, 2] += table_load[i, 0]
    for k in range(count):
        p = source[k]
        if load[p, 0] == np.float32(0.0):
            continue
        share = min(np.float32(1.0), most / load[p, 0])
        load[p, 0] *= share
        for axis in range(1, 4):
            load[p, axis] *= share * np.float32(KEPT_FRICTION)
        px = load[p, 0] * normals[k, 0] + load[p, 1]
        py = load[p, 0] * normals[k, 1] + load[p, 2]
        pz = load[p, 0] * normals[k, 2] + load[p, 3]
        for m in range(4):
            shift(x, bodies[k, m], responses[k, m], px, py, pz)


@compiled
def resolve(
    x, previous, count, bodies, weights, responses, normals, inverse, source, load, thickness, friction, recovery
):  # fmt: skip
    """Keep contacts one thickness apart and hold them by Coulomb friction, one after another and back again.

    What overlapped before the substep is opened by moving where it was, too, by at most ``recovery`` [m]: resolving an
    overlap never throws cloth into the air, and is no part of the load that the next substep starts with.
    """
    zero = np.float32(0.0)
    for step in range(2 * count):
        k = step if step < count else 2 * count - 1 - step
        p = source[k]
        i0, i1, i2, i3 = bodies[k, 0], bodies[k, 1], bodies[k, 2], bodies[k, 3]
        w0, w1, w2, w3 = weights[k, 0], weights[k, 1], weights[k, 2], weights[k, 3]
        nx, ny, nz = normals[k, 0], normals[k, 1], normals[k, 2]
        gx = w0 * x[i0, 0] + w1 * x[i1, 0] + w2 * x[i2, 0] + w3 * x[i3, 0]
        gy = w0 * x[i0, 1] + w1 * x[i1, 1] + w2 * x[i2, 1] + w3 * x[i3, 1]
        gz = w0 * x[i0, 2] + w1 * x[i1, 2] + w2 * x[i2, 2] + w3 * x[i3, 2]
        gap = nx * gx + ny * gy + nz * gz
        carried = load[p, 0]
        if gap >= thickness and carried == zero:
            continue
        hx = w0 * previous[i0, 0] + w1 * previous[i1, 0] + w2 * previous[i2, 0] + w3 * previous[i3, 0]
        hy = w0 * previous[i0, 1] + w1 * previous[i1, 1] + w2 * previous[i2, 1] + w3 * previous[i3, 1]
        hz = w0 * previous[i0, 2] + w1 * previous[i1, 2] + w2 * previous[i2, 2] + w3 * previous[i3, 2]
        before = nx * hx + ny * hy + nz * hz
        goal = min(thickness, before)
        silent = min(np.float32(RECOVERY) * (thickness - goal), recovery) * inverse[k] if step < count else zero
        push = max(zero, carried + (goal - gap) * inverse[k])
        load[p, 0] = push
        change = push - carried
        mx, my, mz = gx - hx, gy - hy, gz - hz
        opening = nx * mx + ny * my + nz * mz
        tx = load[p, 1] - (mx - opening * nx) * inverse[k]
        ty = load[p, 2] - (my - opening * ny) * inverse[k]
        tz = load[p, 3] - (mz - opening * nz) * inverse[k]
        across = nx * tx + ny * ty + nz * tz
        tx, ty, tz = tx - across * nx, ty - across * ny, tz - across * nz
        held = np.sqrt(tx * tx + ty * ty + tz * tz) + np.float32(1e-20)
        share = min(np.float32(1.0), friction * push / held)
        tx, ty, tz = share * tx, share * ty, share * tz
        px = change * nx + tx - load[p, 1]
        py = change * ny + ty - load[p, 2]
        pz = change * nz + tz - load[p, 3]
        load[p, 1], load[p, 2], load[p, 3] = tx, ty, tz
        px, py, pz = px + silent * nx, py + silent * ny, pz + silent * nz
        for m in range(4):
            i = bodies[k, m]
            w = responses[k, m]
            shift(x, i, w, px, py, pz)
            shift(previous, i, w * silent, nx, ny, nz)


@compiled
def table(x, previous, mobility, load, floor, friction):
    """Keep particles on the table and hold them by Coulomb friction.

    Args:
        x, previous: positions [m], shape (N, 3), now and before the substep; ``x`` is changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        load: the push and friction [m] that each particle got in this substep so far, shape (N, 3), changed.
        floor: lowest height of a particle [m].
        friction: coefficient.
    """
    zero = np.float32(0.0)
    for i in range(x.shape[0]):
        carried = load[i, 0]
        if (x[i, 2] >= floor and carried == zero) or mobility[i] == zero:
            continue
        push = max(zero, carried + floor - x[i, 2])
        tx = load[i, 1] - (x[i, 0] - previous[i, 0])
        ty = load[i, 2] - (x[i, 1] - previous[i, 1])
        held = np.sqrt(tx * tx + ty * ty) + np.float32(1e-20)
        share = min(np.float32(1.0), friction * push / held)
        tx, ty = share * tx, share * ty
        x[i, 2] += push - carried
        x[i, 0] += tx - load[i, 1]
        x[i, 1] += ty - load[i, 2]
        load[i, 0], load[i, 1], load[i, 2] = push, tx, ty
