"""The time step: gravity, bending, stretch, contact and table, in one compiled loop over substeps."""

from __future__ import annotations

import numpy as np
from numba import njit

from polyfold_xpbd.contact import pair_normals, resolve_pairs, update_pairs, vertex_normals

__all__ = ["DIVERGED", "RUNNING", "SETTLED", "advance"]

RUNNING, SETTLED, DIVERGED = 0, 1, 2
LOOK_EVERY = 5
"""Substeps between looks at who is near whom and which way the sheet faces."""
LOOK_AFTER = 0.8
"""Look earlier once the fastest particle may have come this far, in pads: a falling flap must not pass unseen."""
BEND_EVERY = 2
"""Substeps per bending step: bending is slow against stretching, and stable far beyond this."""


@njit(cache=True, fastmath=True)
def _bend(x, v, hinges, weights, dt):
    for h in range(hinges.shape[0]):
        a, b, c, d = hinges[h, 0], hinges[h, 1], hinges[h, 2], hinges[h, 3]
        wa, wb, wc, wd = weights[h, 0], weights[h, 1], weights[h, 2], weights[h, 3]
        kx = (wa * x[a, 0] + wb * x[b, 0] + wc * x[c, 0] + wd * x[d, 0]) * dt
        ky = (wa * x[a, 1] + wb * x[b, 1] + wc * x[c, 1] + wd * x[d, 1]) * dt
        kz = (wa * x[a, 2] + wb * x[b, 2] + wc * x[c, 2] + wd * x[d, 2]) * dt
        v[a, 0] -= wa * kx
        v[a, 1] -= wa * ky
        v[a, 2] -= wa * kz
        v[b, 0] -= wb * kx
        v[b, 1] -= wb * ky
        v[b, 2] -= wb * kz
        v[c, 0] -= wc * kx
        v[c, 1] -= wc * ky
        v[c, 2] -= wc * kz
        v[d, 0] -= wd * kx
        v[d, 1] -= wd * ky
        v[d, 2] -= wd * kz


@njit(cache=True, fastmath=True)
def _predict(x, v, previous, mobility, dt, damping, fastest):
    keep = np.float32(1.0) - damping * dt
    fall = np.float32(9.81) * dt
    for i in range(x.shape[0]):
        previous[i, 0], previous[i, 1], previous[i, 2] = x[i, 0], x[i, 1], x[i, 2]
        if mobility[i] == np.float32(0.0):
            continue
        vx, vy, vz = v[i, 0] * keep, v[i, 1] * keep, (v[i, 2] - fall) * keep
        speed_2 = vx * vx + vy * vy + vz * vz
        step = dt
        if speed_2 > fastest * fastest:
            step = dt * fastest / np.sqrt(speed_2)
        x[i, 0] += vx * step
        x[i, 1] += vy * step
        x[i, 2] += vz * step


@njit(cache=True, fastmath=True)
def _stretch(x, mobility, edges, rest_lengths):
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        length = np.sqrt(dx * dx + dy * dy + dz * dz) + np.float32(1e-12)
        wa, wb = mobility[a], mobility[b]
        s = (length - rest_lengths[e]) / (length * (wa + wb + np.float32(1e-12)))
        sa, sb = s * wa, s * wb
        x[a, 0] += sa * dx
        x[a, 1] += sa * dy
        x[a, 2] += sa * dz
        x[b, 0] -= sb * dx
        x[b, 1] -= sb * dy
        x[b, 2] -= sb * dz


@njit(cache=True, fastmath=True)
def _hold_back(x, mobility, particles, anchors, lengths):
    for t in range(particles.shape[0]):
        i, a = particles[t], anchors[t]
        dx, dy, dz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
        d2 = dx * dx + dy * dy + dz * dz
        if d2 > lengths[t] * lengths[t] and mobility[i] > np.float32(0.0):
            s = np.float32(1.0) - lengths[t] / np.sqrt(d2)
            x[i, 0] -= s * dx
            x[i, 1] -= s * dy
            x[i, 2] -= s * dz


@njit(cache=True, fastmath=True)
def _table(x, previous, mobility, supported, rests, floor, friction):
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


@njit(cache=True, fastmath=True)
def _carry(x, grasped, offsets, arm, directions, path, angles, k):
    """Put the grasped particles where the grippers are: moved along the path and turned about the crease's direction."""
    c, s = np.float32(np.cos(angles[k])), np.float32(np.sin(angles[k]))
    for g in range(grasped.shape[0]):
        a = arm[g]
        ux, uy = directions[a, 0], directions[a, 1]
        forward = offsets[g, 0] * ux + offsets[g, 1] * uy
        up = offsets[g, 2]
        turned, risen = c * forward + s * up, c * up - s * forward
        i = grasped[g]
        x[i, 0] = path[k, a, 0] + offsets[g, 0] + (turned - forward) * ux
        x[i, 1] = path[k, a, 1] + offsets[g, 1] + (turned - forward) * uy
        x[i, 2] = path[k, a, 2] + risen


@njit(cache=True)
def _is_finite(x):
    return np.isfinite(x.sum()) and np.abs(x).max() < 100.0


@njit(cache=True, fastmath=True)
def _velocities(x, previous, v, inverse_dt):
    energy, fastest_2 = np.float32(0.0), np.float32(0.0)
    for i in range(x.shape[0]):
        vx = (x[i, 0] - previous[i, 0]) * inverse_dt
        vy = (x[i, 1] - previous[i, 1]) * inverse_dt
        vz = (x[i, 2] - previous[i, 2]) * inverse_dt
        v[i, 0], v[i, 1], v[i, 2] = vx, vy, vz
        speed_2 = vx * vx + vy * vy + vz * vz
        energy += speed_2
        fastest_2 = max(fastest_2, speed_2)
    return energy, fastest_2


@njit(cache=True, fastmath=True)
def _mark_moved(x, listed, moved, limit, everything):
    """Mark the particles that left the place where they were last listed by more than ``limit``; whether there are."""
    any_moved = False
    for i in range(x.shape[0]):
        dx, dy, dz = x[i, 0] - listed[i, 0], x[i, 1] - listed[i, 1], x[i, 2] - listed[i, 2]
        moved[i] = everything or dx * dx + dy * dy + dz * dz > limit * limit
        if moved[i]:
            listed[i, 0], listed[i, 1], listed[i, 2] = x[i, 0], x[i, 1], x[i, 2]
            any_moved = True
    return any_moved


@njit(cache=True)
def advance(
    x, v, previous, listed, mobility, normals, edges, rest_lengths, hinges, hinge_weights, corners, use,
    excluded_start, excluded, start, pj, side, pair_normal, old_start, old_j, old_side, clock,
    grasped, offsets, arm, directions, path, angles, tied, anchors, lengths, first, last, settings, damping, rest_speed,
):  # fmt: skip
    """Run substeps ``first`` to ``last`` in place; stop early once slow (``rest_speed`` > 0) for ten substeps.

    Args (beyond the model's arrays and the state's buffers):
        clock: substeps since the stage began, for how many the cloth has been slow, and how far the fastest particle
            may have come since the last look [nm], int64, shape (3,).
        settings: dt, radius, thickness, pad, table and cloth friction, relaxation, cap, floor, top speed, float32.

    Returns:
        (status, substeps done).
    """
    dt, radius, thickness, pad = settings[0], settings[1], settings[2], settings[3]
    table_friction, cloth_friction, relaxation, cap = settings[4], settings[5], settings[6], settings[7]
    floor, fastest = settings[8], settings[9]
    inverse_dt = np.float32(1.0) / dt
    moved = np.empty(x.shape[0], np.bool_)
    supported, rests = np.zeros(x.shape[0], np.bool_), np.zeros(x.shape[0], np.bool_)
    for k in range(first, last):
        if clock[0] % BEND_EVERY == 0:
            _bend(x, v, hinges, hinge_weights, np.float32(BEND_EVERY) * dt)
        _predict(x, v, previous, mobility, dt, damping, fastest)
        if grasped.shape[0] > 0:
            _carry(x, grasped, offsets, arm, directions, path, angles, k)
            _hold_back(x, mobility, tied, anchors, lengths)
        _stretch(x, mobility, edges, rest_lengths)
        if clock[0] % LOOK_EVERY == 0 or clock[2] > LOOK_AFTER * pad * 1e9:
            clock[2] = 0
            if not _is_finite(x):
                return DIVERGED, k
            vertex_normals(x, corners, use, normals)
            if _mark_moved(x, listed, moved, np.float32(0.3) * pad, clock[0] == 0):
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
        )
        _table(x, previous, mobility, supported, rests, floor, table_friction)
        energy, fastest_2 = _velocities(x, previous, v, inverse_dt)
        clock[2] += int(np.sqrt(fastest_2) * dt * np.float32(1e9))
        if rest_speed > 0:
            clock[1] = clock[1] + 1 if energy < x.shape[0] * rest_speed * rest_speed else 0
            if clock[1] >= 10:
                return SETTLED, k + 1
    return (RUNNING if _is_finite(x) else DIVERGED), last
