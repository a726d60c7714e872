"""The compiled loop over substeps: gravity, bending, tethers, stretch, self-contact, table.

All of it is in one module because numba's cache notices a change only in the file of the function that it stores.

Self-contact is that of oriented discs: a particle keeps others at one thickness along their common normal. A pair
remembers on which side it met, so that a layer pushed through another is pushed back, not out on the wrong side.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["DIVERGED", "RUNNING", "SETTLED", "advance", "vertex_normals"]

compiled = njit(cache=True, fastmath=True, error_model="numpy")
careful = njit(cache=True, error_model="numpy")
"""Without fast maths, which assumes that nothing is NaN."""

RUNNING, SETTLED, DIVERGED = 0, 1, 2
LOOK_EVERY = 5
"""Substeps between looks at who is near whom and which way the sheet faces."""
LOOK_AFTER = 0.8
"""Look earlier once the fastest particle may have come this far, in pads."""
BEND_EVERY = 2
"""Substeps per bending step: bending is slow against stretching, and stable far beyond this."""
UPPER_SHARE = 0.85
"""Share of a push that the upper of two layers takes when the lower one lies on the table."""
CLEAR = 0.5
"""How far off a sheet something must be to be on one side of it, in thicknesses."""


@compiled
def _shift(vectors, i, scale, x, y, z):
    vectors[i, 0] += scale * x
    vectors[i, 1] += scale * y
    vectors[i, 2] += scale * z


@compiled
def vertex_normals(x, corners, use, normals):
    """Area-weighted mean normals of the particles into ``normals``, shape (N, 3).

    Their length says how flat the sheet is there: 1 where all triangles agree, near 0 on a sharp crease.
    """
    areas = np.full(x.shape[0], np.float32(1e-20), np.float32)
    normals[:, :] = np.float32(0.0)
    for t in range(corners.shape[0]):
        a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        vx, vy, vz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area = np.sqrt(nx * nx + ny * ny + nz * nz)
        for k in range(3):
            vertex, weight = corners[t, k], use[t, k]
            _shift(normals, vertex, weight, nx, ny, nz)
            areas[vertex] += weight * area
    for i in range(x.shape[0]):
        inverse = np.float32(1.0) / areas[i]
        normals[i, 0] *= inverse
        normals[i, 1] *= inverse
        normals[i, 2] *= inverse


@compiled
def _side_of(normals, i, dx, dy, dz, d2, radius_2, clear):
    """On which side of particle i's disc the offset lies (+-1, 0 if that isn't clear), and whether it is over it."""
    nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
    along = nx * dx + ny * dy + nz * dz
    flat_2 = nx * nx + ny * ny + nz * nz + np.float32(1e-12)
    over = d2 - along * along / flat_2 < radius_2
    if along > clear:
        return np.int8(1), over
    if along < -clear:
        return np.int8(-1), over
    return np.int8(0), over


@compiled
def _sort_into_cells(cell_of, cells, wanted):
    """Members of every cell, in order: those of cell c are ``members[start[c]:start[c + 1]]``."""
    count = cell_of.shape[0]
    start = np.zeros(cells + 1, np.int32)
    for i in range(count):
        if wanted[i]:
            start[cell_of[i] + 1] += 1
    for cell in range(cells):
        start[cell + 1] += start[cell]
    fill = start[:-1].copy()
    members = np.empty(start[cells] + 1, np.uint32)
    for i in range(count):
        if wanted[i]:
            members[fill[cell_of[i]]] = i
            fill[cell_of[i]] += 1
    return start, members


@compiled
def _may_touch(x, normals, i, j, excluded_start, excluded, tall):
    """Whether the pair isn't excluded and is near enough along its common normal."""
    nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
    sign = np.float32(1.0)
    if nx * normals[j, 0] + ny * normals[j, 1] + nz * normals[j, 2] < 0:
        sign = np.float32(-1.0)
    nx, ny, nz = nx + sign * normals[j, 0], ny + sign * normals[j, 1], nz + sign * normals[j, 2]
    along = nx * (x[j, 0] - x[i, 0]) + ny * (x[j, 1] - x[i, 1]) + nz * (x[j, 2] - x[i, 2])
    if along * along > tall * tall * (nx * nx + ny * ny + nz * nz):
        return False
    touch = True
    for k in range(excluded_start[i], excluded_start[i + 1]):
        touch &= excluded[k] != j
    return touch


@compiled
def _update_pairs(
    x, normals, moved, excluded_start, excluded, radius, thickness, pad, old_start, old_j, old_side, start, pj, side
):  # fmt: skip
    """List the pairs that may touch soon, searching only around the particles that ``moved`` since they were listed.

    Pairs are kept by first particle: ``pj[start[i]:start[i + 1]]``. ``side`` holds, for each, the side of i on which
    j is and the side of j on which i is. A pair of the old list keeps a side while one is still over the other's disc.
    Returns the number of pairs, or -1 if ``pj`` is too short.
    """
    count = x.shape[0]
    reach, tall = radius + pad, thickness + pad
    reach_2, radius_2 = reach * reach, radius * radius
    inverse_cell = np.float32(1.0) / reach
    low_x, low_y = x[0, 0], x[0, 1]
    high_x, high_y = low_x, low_y
    for i in range(count):
        low_x, high_x = min(low_x, x[i, 0]), max(high_x, x[i, 0])
        low_y, high_y = min(low_y, x[i, 1]), max(high_y, x[i, 1])
    columns = int((high_x - low_x) * inverse_cell) + 3
    cells = columns * (int((high_y - low_y) * inverse_cell) + 3)
    cell_of = np.empty(count, np.int32)
    for i in range(count):
        cell_of[i] = (int((x[i, 1] - low_y) * inverse_cell) + 1) * columns + int((x[i, 0] - low_x) * inverse_cell) + 1
    all_start, all_members = _sort_into_cells(cell_of, cells, np.ones(count, np.bool_))
    moved_start, moved_members = _sort_into_cells(cell_of, cells, moved)
    near = np.empty(count, np.uint32)
    # A sheet that is met edge-on has no side yet; guessing one would lock it in.
    clear = np.float32(CLEAR) * thickness
    pairs = 0
    for i in range(count):
        start[i] = pairs
        if pairs + 256 > pj.shape[0]:
            return -1
        if not moved[i]:
            for k in range(old_start[i], old_start[i + 1]):
                pj[pairs] = old_j[k]
                side[pairs, 0], side[pairs, 1] = old_side[k, 0], old_side[k, 1]
                pairs += not moved[old_j[k]]
        cell_start = all_start if moved[i] else moved_start
        members = all_members if moved[i] else moved_members
        found = 0
        # Without branches: whether a candidate is near can't be predicted, and this loop sees most of the work.
        for row in range(-1, 2):
            first = cell_of[i] + row * columns - 1
            for m in range(cell_start[first], cell_start[first + 3]):
                j = members[m]
                dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
                near[found] = j
                found += (j > i) & (dx * dx + dy * dy + dz * dz < reach_2)
        for n in range(min(found, 256)):
            j = near[n]
            if not _may_touch(x, normals, i, j, excluded_start, excluded, tall):
                continue
            dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
            d2 = dx * dx + dy * dy + dz * dz
            side_i, over_i = _side_of(normals, i, dx, dy, dz, d2, radius_2, clear)
            side_j, over_j = _side_of(normals, j, -dx, -dy, -dz, d2, radius_2, clear)
            if over_i or over_j:
                for k in range(old_start[i], old_start[i + 1]):
                    if old_j[k] == j:
                        side_i = old_side[k, 0] if over_i and old_side[k, 0] != 0 else side_i
                        side_j = old_side[k, 1] if over_j and old_side[k, 1] != 0 else side_j
                        break
            pj[pairs] = j
            side[pairs, 0], side[pairs, 1] = side_i, side_j
            pairs += 1
    start[count] = pairs
    return pairs


@compiled
def _pair_normals(normals, start, pj, side, pair_normal):
    """Unit direction from the first particle of each pair to the side where the second belongs.

    Each particle's opinion counts as much as the sheet is flat there. Zero where that gives no clear direction, on
    creases: such a pair is kept apart as two small spheres.
    """
    unclear = np.float32(0.6)
    for i in range(start.shape[0] - 1):
        for p in range(start[i], start[i + 1]):
            j = pj[p]
            si, sj = np.float32(side[p, 0]), np.float32(side[p, 1])
            nx = si * normals[i, 0] - sj * normals[j, 0]
            ny = si * normals[i, 1] - sj * normals[j, 1]
            nz = si * normals[i, 2] - sj * normals[j, 2]
            length = np.sqrt(nx * nx + ny * ny + nz * nz)
            scale = np.float32(1.0) / length if length > unclear else np.float32(0.0)
            pair_normal[p, 0], pair_normal[p, 1], pair_normal[p, 2] = nx * scale, ny * scale, nz * scale


@compiled
def _resolve_pairs(
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
            _shift(x, j, share_j, px, py, pz)
            _shift(x, i, -share_i, px, py, pz)
            _shift(previous, j, share_j * silent, nx, ny, nz)
            _shift(previous, i, -share_i * silent, nx, ny, nz)


@compiled
def _bend(x, v, hinges, weights, dt):
    for h in range(hinges.shape[0]):
        a, b, c, d = hinges[h, 0], hinges[h, 1], hinges[h, 2], hinges[h, 3]
        wa, wb, wc, wd = weights[h, 0], weights[h, 1], weights[h, 2], weights[h, 3]
        kx = (wa * x[a, 0] + wb * x[b, 0] + wc * x[c, 0] + wd * x[d, 0]) * dt
        ky = (wa * x[a, 1] + wb * x[b, 1] + wc * x[c, 1] + wd * x[d, 1]) * dt
        kz = (wa * x[a, 2] + wb * x[b, 2] + wc * x[c, 2] + wd * x[d, 2]) * dt
        _shift(v, a, -wa, kx, ky, kz)
        _shift(v, b, -wb, kx, ky, kz)
        _shift(v, c, -wc, kx, ky, kz)
        _shift(v, d, -wd, kx, ky, kz)


@compiled
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


@compiled
def _stretch(x, mobility, edges, rest_lengths):
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        length = np.sqrt(dx * dx + dy * dy + dz * dz) + np.float32(1e-12)
        wa, wb = mobility[a], mobility[b]
        s = (length - rest_lengths[e]) / (length * (wa + wb + np.float32(1e-12)))
        sa, sb = s * wa, s * wb
        _shift(x, a, sa, dx, dy, dz)
        _shift(x, b, -sb, dx, dy, dz)


@compiled
def _hold_back(x, mobility, particles, anchors, lengths):
    for t in range(particles.shape[0]):
        i, a = particles[t], anchors[t]
        dx, dy, dz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
        d2 = dx * dx + dy * dy + dz * dz
        if d2 > lengths[t] * lengths[t] and mobility[i] > np.float32(0.0):
            s = np.float32(1.0) - lengths[t] / np.sqrt(d2)
            _shift(x, i, -s, dx, dy, dz)


@compiled
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


@compiled
def _carry(x, grasped, offsets, arm, directions, path, angles, k):
    """Put the grasped particles where the grippers are, turned about the crease's direction."""
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


@careful
def _is_finite(x):
    return np.isfinite(x.sum()) and np.abs(x).max() < 100.0


@compiled
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


@compiled
def _mark_moved(x, listed, moved, limit, everything):
    """Mark the particles farther than ``limit`` from where they were last listed; whether there are any."""
    any_moved = False
    for i in range(x.shape[0]):
        dx, dy, dz = x[i, 0] - listed[i, 0], x[i, 1] - listed[i, 1], x[i, 2] - listed[i, 2]
        moved[i] = everything or dx * dx + dy * dy + dz * dz > limit * limit
        if moved[i]:
            listed[i, 0], listed[i, 1], listed[i, 2] = x[i, 0], x[i, 1], x[i, 2]
            any_moved = True
    return any_moved


@careful
def advance(
    x, v, previous, listed, mobility, normals, edges, rest_lengths, hinges, hinge_weights, corners, use,
    excluded_start, excluded, start, pj, side, pair_normal, old_start, old_j, old_side, clock, supported, rests,
    grasped, offsets, arm, directions, path, angles, tied, anchors, lengths, first, last, settings, damping, rest_speed,
):  # fmt: skip
    """Run substeps ``first`` to ``last`` in place; stop once slow (``rest_speed`` > 0) for ten substeps.

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
                found = _update_pairs(
                    x, normals, moved, excluded_start, excluded, radius, thickness, pad,
                    old_start, old_j, old_side, start, pj, side,
                )  # fmt: skip
                if found < 0:
                    return DIVERGED, k
            _pair_normals(normals, start, pj, side, pair_normal)
        clock[0] += 1
        _resolve_pairs(
            x, previous, mobility, supported, rests, start, pj, pair_normal,
            radius, thickness, cloth_friction, relaxation, cap, settings[10],
        )  # fmt: skip
        _table(x, previous, mobility, supported, rests, floor, table_friction)
        energy, fastest_2 = _velocities(x, previous, v, inverse_dt)
        clock[2] += int(np.sqrt(fastest_2) * dt * np.float32(1e9))
        if rest_speed > 0:
            clock[1] = clock[1] + 1 if energy < x.shape[0] * rest_speed * rest_speed else 0
            if clock[1] >= 10:
                return SETTLED, k + 1
    return (RUNNING if _is_finite(x) else DIVERGED), last
