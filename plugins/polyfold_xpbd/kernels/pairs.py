"""Which particles may touch soon, and on which side of each other they belong.

A pair remembers on which side it met, so that a layer pushed through another is pushed back, not out on the wrong side.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

CLEAR = 0.5
"""How far off a sheet something must be to be on one side of it, in thicknesses."""


@compiled
def mark_moved(x, listed, moved, limit, everything):
    """Mark the particles farther than ``limit`` from where they were last listed; whether there are any."""
    any_moved = False
    for i in range(x.shape[0]):
        dx, dy, dz = x[i, 0] - listed[i, 0], x[i, 1] - listed[i, 1], x[i, 2] - listed[i, 2]
        moved[i] = everything or dx * dx + dy * dy + dz * dz > limit * limit
        if moved[i]:
            listed[i, 0], listed[i, 1], listed[i, 2] = x[i, 0], x[i, 1], x[i, 2]
            any_moved = True
    return any_moved


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


@compiled
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
