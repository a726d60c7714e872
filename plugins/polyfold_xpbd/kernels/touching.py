"""Which listed pairs touch, where, and which way they push each other.

Every contact is a vertex on a triangle or an edge on an edge: four particles with weights that sum to zero, and a
normal, both frozen for a few substeps.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

EDGE, KEPT_EDGE = 0.02, 0.1
"""A contact point may lie this far outside its triangle, in shares of its size; that of a contact made before, so far.

Without the difference, vertices that lie exactly above an edge would pass from one triangle to the other forever.
"""
CROSSING, KEPT_CROSSING = -0.01, 0.05
"""The same for edges. Where they only meet at an end, the vertex there is kept off the triangles."""
LIGHT = 0.3
"""A contact gives way as if it had at least this inverse mass.

Where a gripper holds all but a corner that hardly counts, that corner would have to move fifty times the overlap.
"""
FORGOTTEN = 3.0
"""A pair deeper than this on the wrong side, in thicknesses, forgets its side: something else is wrong there."""
NEAR = 1.3
"""What will come this near in the time that contacts are used for is one, in thicknesses."""
PARALLEL = 0.05
"""Edges whose squared sine is below this do not cross; vertices on triangles keep them apart."""


@compiled
def _share_corner(corners, s, t):
    """Whether triangles s and t have a vertex in common."""
    for i in range(3):
        for j in range(3):
            if corners[s, i] == corners[t, j]:
                return True
    return False


@compiled
def _side_of_neighbour(p, end, corners, panel, first, second, side, over):
    """Side on which the vertex of pair p is of a triangle next to the pair's, in the same sheet; 0 if of none."""
    i, t = first[p], second[p]
    begin = p
    while begin > 0 and first[begin - 1] == i:
        begin -= 1
    q = begin
    while q < end and first[q] == i:
        if over[q] != 0 and q != p and panel[second[q]] == panel[t] and _share_corner(corners, second[q], t):
            return side[q]
        q += 1
    return np.int8(0)


@compiled
def _rival(found, since, i, t, nx, ny, nz, corners, panel, second, bodies, normals, source):
    """Which contact from ``since`` on is of vertex i with a triangle next to t, in its plane; ``found`` if none."""
    k = found - 1
    while k >= since and bodies[k, 0] == i:
        other = second[source[k]]
        along = nx * normals[k, 0] + ny * normals[k, 1] + nz * normals[k, 2]
        if along > np.float32(0.9) and panel[other] == panel[t] and _share_corner(corners, other, t):
            return k
        k -= 1
    return found


@compiled
def keep_contacts(found, moved, bodies, weights, responses, normals, inverse, source):
    """Drop contacts of pairs that were listed anew, where ``moved`` is -1, and renumber the others; how many stay."""
    kept = 0
    for k in range(found):
        p = moved[source[k]]
        if p >= 0:
            source[kept], inverse[kept] = p, inverse[k]
            for m in range(4):
                bodies[kept, m], weights[kept, m], responses[kept, m] = bodies[k, m], weights[k, m], responses[k, m]
            for axis in range(3):
                normals[kept, axis] = normals[k, axis]
            kept += 1
    return kept


@compiled
def find_vertex_contacts(
    x, v, window, mobility, corners, panel, thickness, begin, end, found, first, second, side, over, load, bodies,
    weights, responses, normals, inverse, source,
):  # fmt: skip
    """Contacts of vertices and triangles, pairs ``begin`` to ``end``, added to the ``found`` ones; how many in all.

    They are for the next ``window`` [s], and the pairs are all that there are of these vertices.
    ``bodies`` (particles), ``weights`` and ``responses`` (how far each moves per push), shape (C, 4), ``normals``,
    shape (C, 3), ``inverse`` (push per metre of gap) and ``source`` (number of the pair), shape (C,), get them.
    """
    since, one, zero = found, np.float32(1.0), np.float32(0.0)
    for p in range(begin, end):
        i, t = first[p], second[p]
        a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        wx, wy, wz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        rx, ry, rz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        square = nx * nx + ny * ny + nz * nz + np.float32(1e-20)
        beta = ((ry * wz - rz * wy) * nx + (rz * wx - rx * wz) * ny + (rx * wy - ry * wx) * nz) / square
        gamma = ((uy * rz - uz * ry) * nx + (uz * rx - ux * rz) * ny + (ux * ry - uy * rx) * nz) / square
        alpha = one - beta - gamma
        inside = min(alpha, min(beta, gamma))
        if inside < -np.float32(KEPT_EDGE if over[p] == 1 else EDGE):
            over[p], load[p, :] = np.int8(2 if over[p] == 1 else 0), zero
            continue
        height = (nx * rx + ny * ry + nz * rz) / np.sqrt(square)
        if over[p] != 1:
            side[p] = _side_of_neighbour(p, end, corners, panel, first, second, side, over)
        if side[p] == 0 or height * side[p] < -np.float32(FORGOTTEN) * thickness:
            side[p] = np.int8(1) if height >= zero else np.int8(-1)
        over[p] = np.int8(1)
        scale = np.float32(side[p]) / np.sqrt(square)
        nx, ny, nz = nx * scale, ny * scale, nz * scale
        gap = height * np.float32(side[p])
        approach = window * (
            nx * (v[i, 0] - alpha * v[a, 0] - beta * v[b, 0] - gamma * v[c, 0])
            + ny * (v[i, 1] - alpha * v[a, 1] - beta * v[b, 1] - gamma * v[c, 1])
            + nz * (v[i, 2] - alpha * v[a, 2] - beta * v[b, 2] - gamma * v[c, 2])
        )
        if gap + min(approach, zero) > np.float32(NEAR) * thickness:
            load[p, :] = zero
            continue
        # Where sheets lie vertex on vertex, a vertex is over six triangles at once; one of them is enough.
        slot = _rival(found, since, i, t, nx, ny, nz, corners, panel, second, bodies, normals, source)
        if slot < found:
            q = source[slot]
            alike = min(-weights[slot, 1], min(-weights[slot, 2], -weights[slot, 3]))
            if load[q, 0] > zero or (load[p, 0] == zero and alike >= inside):
                load[p, :] = zero
                continue
            load[q, :] = zero
        mass = mobility[i] + alpha * alpha * mobility[a] + beta * beta * mobility[b] + gamma * gamma * mobility[c]
        if mass == zero:
            continue
        bodies[slot, 0], bodies[slot, 1], bodies[slot, 2], bodies[slot, 3] = i, a, b, c
        weights[slot, 0], weights[slot, 1], weights[slot, 2], weights[slot, 3] = one, -alpha, -beta, -gamma
        normals[slot, 0], normals[slot, 1], normals[slot, 2] = nx, ny, nz
        inverse[slot], source[slot] = one / max(mass, np.float32(LIGHT)), p
        for m in range(4):
            responses[slot, m] = weights[slot, m] * mobility[bodies[slot, m]]
        found = max(found, slot + 1)
    return found


@compiled
def find_edge_contacts(
    x, v, window, mobility, edges, thickness, begin, end, found, first, second, side, over, load,
    bodies, weights, responses, normals, inverse, source,
):  # fmt: skip
    """Contacts of edges, pairs ``begin`` to ``end``, added to the ``found`` ones; how many in all."""
    one, zero = np.float32(1.0), np.float32(0.0)
    for p in range(begin, end):
        a, b = edges[first[p], 0], edges[first[p], 1]
        c, d = edges[second[p], 0], edges[second[p], 1]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        wx, wy, wz = x[d, 0] - x[c, 0], x[d, 1] - x[c, 1], x[d, 2] - x[c, 2]
        rx, ry, rz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        square = nx * nx + ny * ny + nz * nz + np.float32(1e-20)
        lengths = (ux * ux + uy * uy + uz * uz) * (wx * wx + wy * wy + wz * wz)
        s = ((ry * wz - rz * wy) * nx + (rz * wx - rx * wz) * ny + (rx * wy - ry * wx) * nz) / square
        t = ((ry * uz - rz * uy) * nx + (rz * ux - rx * uz) * ny + (rx * uy - ry * ux) * nz) / square
        edge = np.float32(KEPT_CROSSING if over[p] == 1 else CROSSING)
        crossing = (s > -edge) & (s < one + edge) & (t > -edge) & (t < one + edge)
        crossing = crossing & (square > np.float32(PARALLEL) * lengths)
        along = nx * rx + ny * ry + nz * rz
        if not crossing:
            over[p], side[p], load[p, :] = np.int8(0), np.int8(0), zero
            continue
        if side[p] == 0:
            side[p] = np.int8(1) if along >= zero else np.int8(-1)
        over[p] = np.int8(1)
        scale = np.float32(side[p]) / np.sqrt(square)
        nx, ny, nz = nx * scale, ny * scale, nz * scale
        gap = along * scale
        approach = window * (
            nx * ((one - t) * v[c, 0] + t * v[d, 0] - (one - s) * v[a, 0] - s * v[b, 0])
            + ny * ((one - t) * v[c, 1] + t * v[d, 1] - (one - s) * v[a, 1] - s * v[b, 1])
            + nz * ((one - t) * v[c, 2] + t * v[d, 2] - (one - s) * v[a, 2] - s * v[b, 2])
        )
        if gap + min(approach, zero) > np.float32(NEAR) * thickness:
            load[p, :] = zero
            continue
        mass = (
            (one - s) * (one - s) * mobility[a] + s * s * mobility[b]
            + (one - t) * (one - t) * mobility[c] + t * t * mobility[d]
        )  # fmt: skip
        if mass == zero:
            continue
        bodies[found, 0], bodies[found, 1], bodies[found, 2], bodies[found, 3] = a, b, c, d
        weights[found, 0], weights[found, 1], weights[found, 2], weights[found, 3] = s - one, -s, one - t, t
        normals[found, 0], normals[found, 1], normals[found, 2] = nx, ny, nz
        inverse[found], source[found] = one / max(mass, np.float32(LIGHT)), p
        for m in range(4):
            responses[found, m] = weights[found, m] * mobility[bodies[found, m]]
        found += 1
    return found
