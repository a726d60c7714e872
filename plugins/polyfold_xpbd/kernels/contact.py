"""Contact: of the cloth with itself, and with the table.

Every contact is a vertex on a triangle or an edge on an edge: four particles with weights that sum to zero, and a
normal, both frozen for a few substeps. Pushes and friction are accumulated per pair over substeps and applied again at
the start of the next (warm starting), so that a stack at rest carries itself and the sweep finds nothing to do.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled, shift

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
KEPT, KEPT_SLANTED, MOST = 1.0, 0.9, 60.0
"""Share of a push that the next substep starts with, where the normal is upright and where it is not.

And the most of it, in what gravity moves a particle by in a substep. Where folds ask for the impossible, pushes that
were kept whole would grow without end.
"""
UPRIGHT = 0.9
"""Height of a unit normal that counts as upright."""
FORGOTTEN = 3.0
"""A pair deeper than this on the wrong side, in thicknesses, forgets its side: something else is wrong there."""
RECOVERY = 0.1
"""Share of an overlap that a substep opens."""
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
def _side_of_neighbour(p, pairs, corners, panel, first, second, side, over):
    """Side on which the vertex of pair p is of a triangle next to the pair's, in the same sheet; 0 if of none."""
    i, t = first[p], second[p]
    begin = p
    while begin > 0 and first[begin - 1] == i:
        begin -= 1
    q = begin
    while q < pairs and first[q] == i:
        if over[q] != 0 and q != p and panel[second[q]] == panel[t] and _share_corner(corners, second[q], t):
            return side[q]
        q += 1
    return np.int8(0)


@compiled
def _rival(found, i, t, nx, ny, nz, corners, panel, second, bodies, normals, source):
    """Which of the ``found`` contacts is of vertex i with a triangle next to t, in its plane; ``found`` if none."""
    k = found - 1
    while k >= 0 and bodies[k, 0] == i:
        other = second[source[k]]
        along = nx * normals[k, 0] + ny * normals[k, 1] + nz * normals[k, 2]
        if along > np.float32(0.9) and panel[other] == panel[t] and _share_corner(corners, other, t):
            return k
        k -= 1
    return found


@compiled
def find_vertex_contacts(
    x, v, window, mobility, corners, panel, thickness, pairs, first, second, side, over, load, bodies, weights,
    responses, normals, inverse, source,
):  # fmt: skip
    """Contacts of listed vertices and triangles for the next ``window`` [s]; how many.

    ``bodies`` and ``weights``, shape (C, 4), ``normals``, shape (C, 3), ``inverse`` (of the contact's mass), shape
    (C,), and ``source`` (number of the pair), shape (C,), get the contacts.
    """
    found, one, zero = 0, np.float32(1.0), np.float32(0.0)
    for p in range(pairs):
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
            side[p] = _side_of_neighbour(p, pairs, corners, panel, first, second, side, over)
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
        slot = _rival(found, i, t, nx, ny, nz, corners, panel, second, bodies, normals, source)
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
    x, v, window, mobility, edges, thickness, first_pair, pairs, found, first, second, side, over, load,
    bodies, weights, responses, normals, inverse, source,
):  # fmt: skip
    """Contacts of listed edges, numbers ``first_pair`` to ``pairs``, added to the ``found`` ones; how many in all."""
    one, zero = np.float32(1.0), np.float32(0.0)
    for p in range(first_pair, pairs):
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


@compiled
def warm_start(x, mobility, count, bodies, responses, normals, source, load, table_load, fall):
    """Apply most of what contacts and the table carried in the substep before.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: 0 for held particles and 1 for free ones, shape (N,).
        count, bodies, responses, normals, source: the contacts, see :func:`find_vertex_contacts`.
        load, table_load: pushes and friction [m] per pair, shape (P, 4), and per particle, shape (N, 3), changed.
        fall: what gravity moves a particle by in a substep [m].
    """
    most = np.float32(MOST) * fall
    for i in range(x.shape[0]):
        if table_load[i, 0] != np.float32(0.0):
            for axis in range(3):
                table_load[i, axis] *= np.float32(KEPT) * mobility[i]
            x[i, 0] += table_load[i, 1]
            x[i, 1] += table_load[i, 2]
            x[i, 2] += table_load[i, 0]
    for k in range(count):
        p = source[k]
        if load[p, 0] == np.float32(0.0):
            continue
        share = np.float32(KEPT if abs(normals[k, 2]) > np.float32(UPRIGHT) else KEPT_SLANTED)
        share = min(share, most / load[p, 0])
        load[p, 0] *= share
        load[p, 1] *= share
        load[p, 2] *= share
        load[p, 3] *= share
        px = load[p, 0] * normals[k, 0] + load[p, 1]
        py = load[p, 0] * normals[k, 1] + load[p, 2]
        pz = load[p, 0] * normals[k, 2] + load[p, 3]
        for m in range(4):
            shift(x, bodies[k, m], responses[k, m], px, py, pz)


@compiled
def resolve(
    x, previous, count, bodies, weights, responses, normals, inverse, source, load, thickness, friction, recovery
):  # fmt: skip
    """Keep contacts one thickness apart and hold them by Coulomb friction, one after another.

    What overlapped before the substep is opened by moving where it was, too, by at most ``recovery`` [m]: resolving an
    overlap never throws cloth into the air, and is no part of the load that the next substep starts with.
    """
    zero = np.float32(0.0)
    for k in range(count):
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
        silent = min(np.float32(RECOVERY) * (thickness - goal), recovery) * inverse[k]
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
        mobility: 0 for held particles and 1 for free ones, shape (N,).
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
