"""Self-contact of cloth as oriented discs: a particle keeps every other at its distance along their common normal.

A pair remembers on which side of the sheet it met (``side``, relative to the material normal of its first particle),
so that a layer that was pushed through another is pushed back instead of out on the wrong side.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["build_pairs", "pair_normals", "resolve_pairs", "vertex_normals"]


@njit(cache=True, fastmath=True)
def vertex_normals(x, corners, use, normals):
    """Area-weighted unit normals of the particles into ``normals``, shape (N, 3)."""
    normals[:, :] = np.float32(0.0)
    for t in range(corners.shape[0]):
        a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        vx, vy, vz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for k in range(3):
            vertex, weight = corners[t, k], use[t, k]
            normals[vertex, 0] += weight * nx
            normals[vertex, 1] += weight * ny
            normals[vertex, 2] += weight * nz
    for i in range(x.shape[0]):
        length = np.sqrt(normals[i, 0] ** 2 + normals[i, 1] ** 2 + normals[i, 2] ** 2) + np.float32(1e-20)
        inverse = np.float32(1.0) / length
        normals[i, 0] *= inverse
        normals[i, 1] *= inverse
        normals[i, 2] *= inverse


@njit(cache=True, fastmath=True)
def build_pairs(x, normals, excluded_start, excluded, radius, thickness, pad, old_start, old_j, old_side, start, pj, side):
    """Fill the list of pairs that may touch before a particle has moved by half of ``pad``.

    Pairs are kept by first particle: ``pj[start[i]:start[i + 1]]`` with ``side`` +-1. A pair of the old list that is
    still within its discs keeps its side. Returns the number of pairs, or -1 if ``pj`` is too short.
    """
    count = x.shape[0]
    reach = radius + pad
    tall = thickness + pad
    inverse_cell = np.float32(1.0) / reach
    low_x, low_y = x[0, 0], x[0, 1]
    high_x, high_y = low_x, low_y
    for i in range(count):
        low_x, high_x = min(low_x, x[i, 0]), max(high_x, x[i, 0])
        low_y, high_y = min(low_y, x[i, 1]), max(high_y, x[i, 1])
    columns = int((high_x - low_x) * inverse_cell) + 3
    rows = int((high_y - low_y) * inverse_cell) + 3
    cell_start = np.zeros(columns * rows + 1, np.int32)
    cell_of = np.empty(count, np.int32)
    for i in range(count):
        cell = (int((x[i, 1] - low_y) * inverse_cell) + 1) * columns + int((x[i, 0] - low_x) * inverse_cell) + 1
        cell_of[i] = cell
        cell_start[cell + 1] += 1
    for cell in range(columns * rows):
        cell_start[cell + 1] += cell_start[cell]
    fill = cell_start[:-1].copy()
    members = np.empty(count, np.uint32)
    sorted_x = np.empty((count, 3), np.float32)
    for i in range(count):
        at = fill[cell_of[i]]
        fill[cell_of[i]] += 1
        members[at] = i
        sorted_x[at, 0], sorted_x[at, 1], sorted_x[at, 2] = x[i, 0], x[i, 1], x[i, 2]
    reach_2 = reach * reach + tall * tall
    pairs = 0
    for i in range(count):
        start[i] = pairs
        for row in range(-1, 2):
            first = cell_of[i] + row * columns - 1
            for m in range(cell_start[first], cell_start[first + 3]):
                dx = sorted_x[m, 0] - x[i, 0]
                dy = sorted_x[m, 1] - x[i, 1]
                dz = sorted_x[m, 2] - x[i, 2]
                d2 = dx * dx + dy * dy + dz * dz
                if d2 > reach_2:
                    continue
                j = members[m]
                if j <= i:
                    continue
                aligned = normals[i, 0] * normals[j, 0] + normals[i, 1] * normals[j, 1] + normals[i, 2] * normals[j, 2]
                sign = np.float32(1.0) if aligned >= 0 else np.float32(-1.0)
                nx = normals[i, 0] + sign * normals[j, 0]
                ny = normals[i, 1] + sign * normals[j, 1]
                nz = normals[i, 2] + sign * normals[j, 2]
                along = (nx * dx + ny * dy + nz * dz) / np.sqrt(nx * nx + ny * ny + nz * nz + np.float32(1e-20))
                lateral_2 = d2 - along * along
                if abs(along) > tall or lateral_2 > reach * reach:
                    continue
                skip = False
                for k in range(excluded_start[i], excluded_start[i + 1]):
                    if excluded[k] == j:
                        skip = True
                        break
                if skip:
                    continue
                which = np.int8(1) if along >= 0 else np.int8(-1)
                if lateral_2 < radius * radius:
                    for k in range(old_start[i], old_start[i + 1]):
                        if old_j[k] == j:
                            which = old_side[k]
                            break
                if pairs >= pj.shape[0]:
                    return -1
                pj[pairs] = j
                side[pairs] = which
                pairs += 1
    start[count] = pairs
    return pairs


@njit(cache=True, fastmath=True)
def pair_normals(normals, start, pj, side, pair_normal):
    """Common normal of each pair, pointing from its first particle to the side where the second belongs."""
    for i in range(start.shape[0] - 1):
        for p in range(start[i], start[i + 1]):
            j = pj[p]
            aligned = normals[i, 0] * normals[j, 0] + normals[i, 1] * normals[j, 1] + normals[i, 2] * normals[j, 2]
            sign = np.float32(1.0) if aligned >= 0 else np.float32(-1.0)
            nx = normals[i, 0] + sign * normals[j, 0]
            ny = normals[i, 1] + sign * normals[j, 1]
            nz = normals[i, 2] + sign * normals[j, 2]
            scale = np.float32(side[p]) / np.sqrt(nx * nx + ny * ny + nz * nz + np.float32(1e-20))
            pair_normal[p, 0], pair_normal[p, 1], pair_normal[p, 2] = nx * scale, ny * scale, nz * scale


@njit(cache=True, fastmath=True)
def resolve_pairs(x, previous, mobility, start, pj, pair_normal, radius, thickness, friction, relaxation, cap):
    """Push overlapping discs apart and hold them by Coulomb friction.

    Only the part of a push that stops an approach may change velocities; the rest moves ``previous`` along, so that
    resolving an overlap never throws cloth into the air.
    """
    radius_2 = radius * radius
    zero = np.float32(0.0)
    for i in range(start.shape[0] - 1):
        for p in range(start[i], start[i + 1]):
            j = pj[p]
            nx, ny, nz = pair_normal[p, 0], pair_normal[p, 1], pair_normal[p, 2]
            dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
            along = nx * dx + ny * dy + nz * dz
            if along >= thickness:
                continue
            if dx * dx + dy * dy + dz * dz - along * along > radius_2:
                continue
            total = mobility[i] + mobility[j]
            if total == zero:
                continue
            share_i, share_j = mobility[i] / total, mobility[j] / total
            push = min(relaxation * (thickness - along), cap)
            mx = (x[j, 0] - previous[j, 0]) - (x[i, 0] - previous[i, 0])
            my = (x[j, 1] - previous[j, 1]) - (x[i, 1] - previous[i, 1])
            mz = (x[j, 2] - previous[j, 2]) - (x[i, 2] - previous[i, 2])
            opening = nx * mx + ny * my + nz * mz
            tx, ty, tz = mx - opening * nx, my - opening * ny, mz - opening * nz
            slip = np.sqrt(tx * tx + ty * ty + tz * tz) + np.float32(1e-12)
            hold = min(np.float32(1.0), friction * push / slip)
            silent = push - min(push, max(-opening, zero))
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
