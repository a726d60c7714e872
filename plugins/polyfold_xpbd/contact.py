"""Self-contact of cloth as oriented discs: a particle keeps every other at its distance along their common normal.

A pair remembers on which side of the sheet it met (``side``, relative to the material normal of its first particle),
so that a layer that was pushed through another is pushed back instead of out on the wrong side.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["pair_normals", "resolve_pairs", "update_pairs", "vertex_normals"]

UPPER_SHARE = 0.85
"""Share of a push that the upper of two layers takes when the lower one rests on the table."""
CLEAR = 0.5
"""How far off a sheet something must be to be on one side of it, in thicknesses."""


@njit(cache=True, fastmath=True)
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
            normals[vertex, 0] += weight * nx
            normals[vertex, 1] += weight * ny
            normals[vertex, 2] += weight * nz
            areas[vertex] += weight * area
    for i in range(x.shape[0]):
        inverse = np.float32(1.0) / areas[i]
        normals[i, 0] *= inverse
        normals[i, 1] *= inverse
        normals[i, 2] *= inverse


@njit(cache=True, fastmath=True)
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


@njit(cache=True, fastmath=True)
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


@njit(cache=True, fastmath=True)
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
    for k in range(excluded_start[i], excluded_start[i + 1]):
        if excluded[k] == j:
            return False
    return True


@njit(cache=True, fastmath=True)
def update_pairs(
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


@njit(cache=True, fastmath=True)
def pair_normals(normals, start, pj, side, pair_normal):
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


@njit(cache=True, fastmath=True)
def resolve_pairs(
    x, previous, mobility, supported, rests, start, pj, pair_normal,
    radius, thickness, friction, relaxation, cap, recovery,
):  # fmt: skip
    """Push overlapping discs apart and hold them by Coulomb friction.

    A push changes velocities only as far as it stops an approach and opens the overlap by ``recovery`` per substep; the
    rest moves ``previous`` along, so that resolving an overlap never throws cloth into the air. ``supported`` says which
    particles rested on the table, directly or on others, in the substep before; ``rests`` gathers it for the next.
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
            x[j, 0] += share_j * px
            x[j, 1] += share_j * py
            x[j, 2] += share_j * pz
            x[i, 0] -= share_i * px
            x[i, 1] -= share_i * py
            x[i, 2] -= share_i * pz
            previous[j, 0] += share_j * silent * nx
            previous[j, 1] += share_j * silent * ny
            previous[j, 2] += share_j * silent * nz
            previous[i, 0] -= share_i * silent * nx
            previous[i, 1] -= share_i * silent * ny
            previous[i, 2] -= share_i * silent * nz
