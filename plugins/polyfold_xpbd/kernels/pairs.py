"""Which vertices and triangles, and which edges, may touch soon, and on which side of each other they belong.

A list holds what comes near within a horizon if everything goes on at its velocity, and lasts until something leaves
that path by more than the slack: a packet carried through the air needs no new list at every step. A pair remembers on
which side it met, so that a ply pushed through another is pushed back, not out on the wrong side; a vertex that slides
from one triangle to the next takes its side along.

A list of pairs is a tuple of arrays with room for ``capacity`` pairs: ``first`` and ``second`` (vertex and triangle, or
edge and edge), ``side`` (+-1, or 0 if not known), ``over`` (1 if one was over the other when last looked, 2 if only
before that), and ``load`` (the accumulated push and friction [m], shape (capacity, 4)).
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.near import ROOM, gather, sort_by_cell, swept_boxes, with_any
from polyfold_xpbd.kernels.vectors import compiled

FLATTER = 0.5
"""How far back to flat a bent sheet has to come to count as flat again."""
COVERED, UNBENT, BEHIND = -0.02, 0.8, 0.7
"""A ply covers what is behind it where a vertex is this far inside one of its triangles and faces it this squarely.

Behind is what is farther than it by this many thicknesses.
"""
CELL = 0.5
"""Side of a cell that boxes are sorted into, in edge lengths."""


@compiled
def mark_sharp(normals, edges, sharp, bent):
    """Mark the edges where the sheet is bent: the mean normal of either end is shorter than ``bent``.

    An edge stays marked until it is clearly flat again; contacts that came and went would keep creases moving.
    """
    flat = bent + np.float32(FLATTER) * (np.float32(1.0) - bent)
    bent_2, flat_2 = bent * bent, flat * flat
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        length_a = normals[a, 0] * normals[a, 0] + normals[a, 1] * normals[a, 1] + normals[a, 2] * normals[a, 2]
        length_b = normals[b, 0] * normals[b, 0] + normals[b, 1] * normals[b, 1] + normals[b, 2] * normals[b, 2]
        sharp[e] = min(length_a, length_b) < (flat_2 if sharp[e] else bent_2)


@compiled
def _frames(x, v, corners, chosen, frames):
    """What tells how a point lies to the chosen triangles, into ``frames``, shape (K, 12).

    Unit normal; the vectors whose products with the way from the first corner are the second and third barycentric
    coordinates [1/m]; mean velocity [m/s].
    """
    third, one = np.float32(1.0 / 3.0), np.float32(1.0)
    for t in range(chosen.shape[0]):
        a, b, c = corners[chosen[t], 0], corners[chosen[t], 1], corners[chosen[t], 2]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        wx, wy, wz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        inverse = one / np.sqrt(nx * nx + ny * ny + nz * nz + np.float32(1e-20))
        nx, ny, nz = nx * inverse, ny * inverse, nz * inverse
        frames[t, 0], frames[t, 1], frames[t, 2] = nx, ny, nz
        frames[t, 3] = (wy * nz - wz * ny) * inverse
        frames[t, 4] = (wz * nx - wx * nz) * inverse
        frames[t, 5] = (wx * ny - wy * nx) * inverse
        frames[t, 6] = (ny * uz - nz * uy) * inverse
        frames[t, 7] = (nz * ux - nx * uz) * inverse
        frames[t, 8] = (nx * uy - ny * ux) * inverse
        for axis in range(3):
            frames[t, 9 + axis] = third * (v[a, axis] + v[b, axis] + v[c, axis])


@compiled
def _enter(p, one, other, first, second, side, over, load):
    """Make pair p a pair of these two that remembers nothing."""
    first[p], second[p], side[p], over[p] = one, other, np.int8(0), np.int8(0)
    for m in range(4):
        load[p, m] = np.float32(0.0)


@compiled
def set_aside(pairs, moved, second, side, over, load, old_second, old_side, old_over, old_load):
    """Copy the first ``pairs`` of the list to the old list, as moved nowhere."""
    for k in range(pairs):
        moved[k] = -1
        old_second[k], old_side[k], old_over[k] = second[k], side[k], over[k]
        for m in range(4):
            old_load[k, m] = load[k, m]


@compiled
def _replace(new_starts, new_stops, starts, stops):
    """Let ranges be the new ones, shapes (N,)."""
    for i in range(starts.shape[0]):
        starts[i], stops[i] = new_starts[i], new_stops[i]


@compiled
def _keep(p, one, k, old_second, old_side, old_over, old_load, first, second, side, over, load, moved):
    """Make pair p the old pair k, whose first member is ``one``."""
    first[p], second[p], side[p], over[p] = one, old_second[k], old_side[k], old_over[k]
    for m in range(4):
        load[p, m] = old_load[k, m]
    moved[k] = p


@compiled
def _recall(p, other, begin, end, old_second, old_side, old_over, old_load, side, over, load):
    """Let pair p take over what the pair with ``other`` among the old ones from ``begin`` to ``end`` remembers."""
    for k in range(begin, end):
        if old_second[k] == other:
            side[p], over[p] = old_side[k], old_over[k]
            for m in range(4):
                load[p, m] = old_load[k, m]


@compiled
def list_vertex_pairs(
    x, v, normals, horizon, reach, edge_length, corners, thickness, order, close, again,
    starts, stops, moved, old_second, old_side, old_over, old_load, first, second, side, over, load,
):  # fmt: skip
    """List vertices and triangles that come within ``reach`` [m] of each other, vertex by vertex in ``order``.

    What lies behind another ply is left out: the vertex can't get there before that ply does. Vertices that are not
    marked in ``again``, shape (N,), keep the pairs that they have, and ``moved``, shape (P,), says which these are now.
    ``close``, shape (N,), marks all particles of triangles that the others may be near.

    Returns:
        The number of pairs; -1 if there is no room for them.
    """
    chosen = with_any(corners, close)
    boxes = swept_boxes(x, v, horizon, corners, chosen, reach)
    cell = np.float32(CELL) * edge_length
    start, members, in_order, columns, rows, grid = sort_by_cell(boxes, cell)
    asking = np.zeros(chosen.shape[0], np.bool_)
    frames = np.empty((chosen.shape[0], 12), np.float32)
    _frames(x, v, corners, chosen, frames)
    zero, one, slope = np.float32(0.0), np.float32(1.0), np.float32(1.3) / edge_length
    away, upper = np.empty(ROOM, np.float32), np.empty(ROOM, np.bool_)
    near = np.empty(ROOM, np.int32)
    box, hits = np.empty(6, np.float32), np.zeros(ROOM, np.uint8)
    new_starts, new_stops = np.zeros(x.shape[0], np.int32), np.zeros(x.shape[0], np.int32)
    pairs = 0
    for i in order:
        new_starts[i] = pairs
        if not again[i]:
            if pairs + stops[i] - starts[i] > first.shape[0]:
                return -1
            for k in range(starts[i], stops[i]):
                _keep(pairs, i, k, old_second, old_side, old_over, old_load, first, second, side, over, load, moved)
                pairs += 1
            new_stops[i] = pairs
            continue
        for axis in range(3):
            ahead = x[i, axis] + horizon * v[i, axis]
            box[axis], box[axis + 3] = min(x[i, axis], ahead), max(x[i, axis], ahead)
        found = gather(box, cell, start, members, in_order, columns, rows, grid, -1, asking, hits, near)
        if pairs + found > first.shape[0]:
            return -1
        kept, cover_above, cover_below = 0, np.float32(1.0), np.float32(1.0)
        for n in range(found):
            t = near[n]
            triangle = chosen[t]
            a = corners[triangle, 0]
            if i == a or i == corners[triangle, 1] or i == corners[triangle, 2]:
                continue
            rx, ry, rz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
            height = frames[t, 0] * rx + frames[t, 1] * ry + frames[t, 2] * rz
            mx = horizon * (v[i, 0] - frames[t, 9])
            my = horizon * (v[i, 1] - frames[t, 10])
            mz = horizon * (v[i, 2] - frames[t, 11])
            rise = frames[t, 0] * mx + frames[t, 1] * my + frames[t, 2] * mz
            if min(height, height + rise) > reach or max(height, height + rise) < -reach:
                continue
            beta = frames[t, 3] * rx + frames[t, 4] * ry + frames[t, 5] * rz
            gamma = frames[t, 6] * rx + frames[t, 7] * ry + frames[t, 8] * rz
            margin = slope * (reach + np.sqrt(mx * mx + my * my + mz * mz))
            if min(beta, min(gamma, one - beta - gamma)) < -margin:
                continue
            near[kept] = triangle
            away[kept] = height
            # Which way a triangle is from here, by its own normal turned to this vertex's.
            facing = frames[t, 0] * normals[i, 0] + frames[t, 1] * normals[i, 1] + frames[t, 2] * normals[i, 2]
            above = (height < zero) == (facing > zero)
            upper[kept] = above
            if min(beta, min(gamma, one - beta - gamma)) > np.float32(COVERED) and abs(facing) > np.float32(UNBENT):
                if above:
                    cover_above = min(cover_above, abs(height) + abs(rise))
                else:
                    cover_below = min(cover_below, abs(height) + abs(rise))
            kept += 1
        for n in range(kept):
            if abs(away[n]) > (cover_above if upper[n] else cover_below) + np.float32(BEHIND) * thickness:
                continue
            _enter(pairs, i, near[n], first, second, side, over, load)
            _recall(pairs, near[n], starts[i], stops[i], old_second, old_side, old_over, old_load, side, over, load)
            pairs += 1
        new_stops[i] = pairs
    _replace(new_starts, new_stops, starts, stops)
    return pairs


@compiled
def _may_meet(x, v, horizon, reach, edge_length, a, b, c, d):
    """Whether edges a-b and c-d cross within ``reach`` [m] of each other, or may after their travel in the horizon."""
    one = np.float32(1.0)
    ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
    wx, wy, wz = x[d, 0] - x[c, 0], x[d, 1] - x[c, 1], x[d, 2] - x[c, 2]
    rx, ry, rz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
    uu, ww, uw = ux * ux + uy * uy + uz * uz, wx * wx + wy * wy + wz * wz, ux * wx + uy * wy + uz * wz
    ur, wr = ux * rx + uy * ry + uz * rz, wx * rx + wy * ry + wz * rz
    square = uu * ww - uw * uw
    if square < np.float32(0.02) * uu * ww:
        return False
    s, t = (ur * ww - wr * uw) / square, (ur * uw - wr * uu) / square
    half = np.float32(0.5) * horizon
    mx = half * (v[c, 0] + v[d, 0] - v[a, 0] - v[b, 0])
    my = half * (v[c, 1] + v[d, 1] - v[a, 1] - v[b, 1])
    mz = half * (v[c, 2] + v[d, 2] - v[a, 2] - v[b, 2])
    travel = np.sqrt(mx * mx + my * my + mz * mz)
    margin = (reach + travel) / edge_length
    if min(s, t) < -margin or max(s, t) > one + margin:
        return False
    gx, gy, gz = rx + t * wx - s * ux, ry + t * wy - s * uy, rz + t * wz - s * uz
    return gx * gx + gy * gy + gz * gz < (reach + travel) * (reach + travel)


@compiled
def list_edge_pairs(
    x, v, horizon, reach, edge_length, edges, sharp, whole, close, again, starts, stops, pairs, moved,
    old_second, old_side, old_over, old_load, first, second, side, over, load,
):  # fmt: skip
    """List edges that come within ``reach`` [m] of each other where at least one lies in a ``sharp`` bend, shape (E,).

    They are added to the ``pairs`` listed already. Unless the ``whole`` list is made anew, pairs stay of which neither
    edge is marked in ``again``, shape (E,), and ``moved``, shape (P,), says which they are now. ``close``, shape (N,),
    marks all particles of edges that the others may be near.

    Returns:
        The number of pairs; -1 if there is no room for them.
    """
    chosen = with_any(edges, close)
    boxes = swept_boxes(x, v, horizon, edges, chosen, reach)
    cell = np.float32(CELL) * edge_length
    start, members, in_order, columns, rows, grid = sort_by_cell(boxes, cell)
    place = np.full(edges.shape[0], -1, np.int32)
    asking = np.empty(chosen.shape[0], np.bool_)
    for m in range(chosen.shape[0]):
        place[chosen[members[m]]] = m
        asking[m] = sharp[chosen[members[m]]] if whole else again[chosen[members[m]]]
    near = np.empty(ROOM, np.int32)
    box, hits = np.empty(6, np.float32), np.zeros(ROOM, np.uint8)
    new_starts, new_stops = np.zeros(edges.shape[0], np.int32), np.zeros(edges.shape[0], np.int32)
    for e in range(edges.shape[0]):
        new_starts[e] = pairs
        if sharp[e] if whole else again[e]:
            mine = place[e]
            for axis in range(3):
                box[axis], box[axis + 3] = in_order[axis, mine] + reach, in_order[axis + 3, mine] - reach
            found = gather(box, cell, start, members, in_order, columns, rows, grid, mine, asking, hits, near)
            if pairs + found > first.shape[0]:
                return -1
            a, b = edges[e, 0], edges[e, 1]
            for n in range(found):
                f = chosen[near[n]]
                c, d = edges[f, 0], edges[f, 1]
                if a in (c, d) or b in (c, d) or not (sharp[e] or sharp[f]):
                    continue
                if not _may_meet(x, v, horizon, reach, edge_length, a, b, c, d):
                    continue
                _enter(pairs, e, f, first, second, side, over, load)
                _recall(pairs, f, starts[e], stops[e], old_second, old_side, old_over, old_load, side, over, load)
                _recall(pairs, e, starts[f], stops[f], old_second, old_side, old_over, old_load, side, over, load)
                pairs += 1
        elif not whole:
            if pairs + stops[e] - starts[e] > first.shape[0]:
                return -1
            for k in range(starts[e], stops[e]):
                if not again[old_second[k]]:
                    _keep(pairs, e, k, old_second, old_side, old_over, old_load, first, second, side, over, load, moved)
                    pairs += 1
        new_stops[e] = pairs
    _replace(new_starts, new_stops, starts, stops)
    return pairs
