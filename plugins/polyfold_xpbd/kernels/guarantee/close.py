"""All vertices and triangles, and all edges, that could touch soon: what is watched, so that it stays apart.

Unlike the pairs that contact is solved for, none is left out, whatever lies between.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polyfold_xpbd.kernels.guarantee.distance import between_edges, from_triangle
from polyfold_xpbd.kernels.near import ROOM, gather, sort_by_cell, swept_boxes
from polyfold_xpbd.kernels.pairs import CELL
from polyfold_xpbd.kernels.vectors import compiled, copy_rows

AHEAD, STRAY, WIDER = 8, 0.0005, 3.0
"""Substeps for which a list looks ahead, and how far particles may leave that path [m].

What does may then leave it so many times as far as it did, and what it could meet on the way is added to the list.
"""
MOST_STRAYS = 32
"""If more leave their path at once, all is listed anew."""
PAIRS_PER_PARTICLE = 400
"""Room in the list. Where there is none, it looks less far ahead."""


class Watch(NamedTuple):
    """What is watched.

    Attributes:
        bodies: particles of every pair: a vertex and a triangle's, or two edges', shape (room, 4).
        ways: how far apart these are [m], and how fast that changes at most [m/s], when listed, shape (room, 2).
        normals: unit vectors that part them; zero if not known, shape (room, 3).
        counts: pairs of a vertex and a triangle, at the front, and of edges, at the back; substeps since all was
            listed, and for how many it holds; int64, shape (4,).
        listed, foreseen: where particles were when all was listed [m], and how fast they were thought to go on [m/s],
            shape (N, 3).
        boxes: what each particle may reach while the list holds [m], low corner, then high corner, shape (N, 6).
        allowed, off: how far each may leave its path, and how far it is off now [m], shape (N,).
        moved, zones, sums: what impact zones need, shapes (N,), (N,) and (N, 6).
    """

    bodies: NDArray[Any]
    ways: NDArray[Any]
    normals: NDArray[Any]
    counts: NDArray[Any]
    listed: NDArray[Any]
    foreseen: NDArray[Any]
    boxes: NDArray[Any]
    allowed: NDArray[Any]
    off: NDArray[Any]
    moved: NDArray[Any]
    zones: NDArray[Any]
    sums: NDArray[Any]


def watch_memory(count: int) -> Watch:
    """Room to watch ``count`` particles."""
    room = PAIRS_PER_PARTICLE * count
    return Watch(
        np.zeros((room, 4), np.int32),
        np.zeros((room, 2), np.float32),
        np.zeros((room, 3), np.float32),
        np.zeros(4, np.int64),
        np.zeros((count, 3), np.float32),
        np.zeros((count, 3), np.float32),
        np.zeros((count, 6), np.float32),
        np.zeros(count, np.float32),
        np.zeros(count, np.float32),
        np.zeros(count, np.int32),
        np.zeros(count, np.int32),
        np.zeros((count, 6), np.float32),
    )


@compiled
def _speed_2(v, i, j):
    """How fast two particles move apart or together, squared [m²/s²]."""
    dx, dy, dz = v[i, 0] - v[j, 0], v[i, 1] - v[j, 1], v[i, 2] - v[j, 2]
    return dx * dx + dy * dy + dz * dz


@compiled
def _enter(bodies, ways, normals, p, a, b, c, d, distance, speed):
    """Make pair p these four particles, ``distance`` [m] apart, which changes by at most ``speed`` [m/s]; 1."""
    bodies[p, 0], bodies[p, 1], bodies[p, 2], bodies[p, 3] = a, b, c, d
    ways[p, 0], ways[p, 1] = distance, speed
    normals[p, 0], normals[p, 1], normals[p, 2] = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    return 1


@compiled
def _enter_vertex(x, v, allowed, horizon, i, corners, t, bodies, ways, normals, p):
    """Make pair p a vertex and a triangle, unless these can't meet within ``horizon`` [s]; how many were entered."""
    a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
    if i in (a, b, c):
        return 0
    dx, dy, dz = from_triangle(x, i, a, b, c)
    speed = np.sqrt(max(_speed_2(v, i, a), max(_speed_2(v, i, b), _speed_2(v, i, c))))
    off = allowed[i] + max(allowed[a], max(allowed[b], allowed[c]))
    distance = np.float32(np.sqrt(dx * dx + dy * dy + dz * dz))
    if distance > off + horizon * speed:
        return 0
    return _enter(bodies, ways, normals, p, i, a, b, c, distance, speed)


@compiled
def _enter_edges(x, v, allowed, horizon, edges, e, f, bodies, ways, normals, p):
    """Make pair p these two edges, unless they can't meet within ``horizon`` [s]; how many were entered."""
    a, b, c, d = edges[e, 0], edges[e, 1], edges[f, 0], edges[f, 1]
    if a in (c, d) or b in (c, d):
        return 0
    dx, dy, dz = between_edges(x, a, b, c, d)
    speed = np.sqrt(max(max(_speed_2(v, a, c), _speed_2(v, a, d)), max(_speed_2(v, b, c), _speed_2(v, b, d))))
    off = max(allowed[a], allowed[b]) + max(allowed[c], allowed[d])
    distance = np.float32(np.sqrt(dx * dx + dy * dy + dz * dz))
    if distance > off + horizon * speed:
        return 0
    return _enter(bodies, ways, normals, p, a, b, c, d, distance, speed)


@compiled
def _list_vertices(watch, horizon, cell, corners):
    """Enter all vertices and triangles at the front; False if there is no room."""
    everything = np.arange(corners.shape[0])
    x, v, allowed, reach = watch.listed, watch.foreseen, watch.allowed, watch.boxes
    bodies, ways, normals = watch.bodies, watch.ways, watch.normals
    boxes = swept_boxes(x, v, horizon, corners, everything, np.float32(STRAY))
    start, members, in_order, columns, rows, grid = sort_by_cell(boxes, cell)
    asking = np.zeros(corners.shape[0], np.bool_)
    near, hits = np.empty(ROOM, np.int32), np.zeros(ROOM, np.uint8)
    pairs, most = 0, bodies.shape[0]
    for i in range(x.shape[0]):
        found = gather(reach[i], cell, start, members, in_order, columns, rows, grid, -1, asking, hits, near)
        if found >= ROOM - 1 or pairs + found > most:
            return False
        for n in range(found):
            pairs += _enter_vertex(x, v, allowed, horizon, i, corners, near[n], bodies, ways, normals, pairs)
    watch.counts[0] = pairs
    return True


@compiled
def _list_edges(watch, horizon, cell, edges):
    """Enter all pairs of edges at the back; False if there is no room."""
    everything = np.arange(edges.shape[0])
    x, v, allowed = watch.listed, watch.foreseen, watch.allowed
    bodies, ways, normals = watch.bodies, watch.ways, watch.normals
    boxes = swept_boxes(x, v, horizon, edges, everything, np.float32(STRAY))
    start, members, in_order, columns, rows, grid = sort_by_cell(boxes, cell)
    asking = np.ones(edges.shape[0], np.bool_)
    near, box, hits = np.empty(ROOM, np.int32), np.empty(6, np.float32), np.zeros(ROOM, np.uint8)
    least, last = watch.counts[0], bodies.shape[0] - 1
    pairs = 0
    for mine in range(edges.shape[0]):
        for axis in range(6):
            box[axis] = in_order[axis, mine]
        found = gather(box, cell, start, members, in_order, columns, rows, grid, mine, asking, hits, near)
        if found >= ROOM - 1 or least + pairs + found > last:
            return False
        e = members[mine]
        for n in range(found):
            pairs += _enter_edges(x, v, allowed, horizon, edges, e, near[n], bodies, ways, normals, last - pairs)
    watch.counts[1] = pairs
    return True


@compiled
def _reach(watch, i, horizon):
    """Set what particle i may reach in the ``horizon`` [s]."""
    for axis in range(3):
        here = watch.listed[i, axis]
        there = here + horizon * watch.foreseen[i, axis]
        watch.boxes[i, axis] = min(here, there) - watch.allowed[i]
        watch.boxes[i, axis + 3] = max(here, there) + watch.allowed[i]


@compiled
def list_close(x, start, dt, edge_length, corners, edges, watch):
    """List all that is close on the way from the start of a substep to its end, and as far beyond as there is room for.

    Returns:
        Whether there was room for the substep itself.
    """
    inverse, counts = np.float32(1.0) / dt, watch.counts
    copy_rows(start, watch.listed)
    watch.allowed[:] = np.float32(STRAY)
    for i in range(x.shape[0]):
        for axis in range(3):
            watch.foreseen[i, axis] = inverse * (x[i, axis] - start[i, axis])
    cell, ahead = np.float32(CELL) * edge_length, AHEAD
    while ahead > 0:
        horizon = np.float32(ahead) * dt
        counts[0], counts[1], counts[2], counts[3] = 0, 0, 0, ahead
        for i in range(x.shape[0]):
            _reach(watch, i, horizon)
        if _list_vertices(watch, horizon, cell, corners) and _list_edges(watch, horizon, cell, edges):
            return True
        ahead //= 2
    return False


@compiled
def _meet(p, q):
    """Whether two boxes [m], shape (6,), meet."""
    return (
        (p[0] <= q[3]) & (p[3] >= q[0]) & (p[1] <= q[4]) & (p[4] >= q[1]) & (p[2] <= q[5]) & (p[5] >= q[2])
    )  # fmt: skip


@compiled
def _grow(box, other):
    """Grow a box [m], shape (6,), to hold the other."""
    for axis in range(3):
        box[axis], box[axis + 3] = min(box[axis], other[axis]), max(box[axis + 3], other[axis + 3])


@compiled
def _around(boxes, corners, box, chosen):
    """Which primitives with vertices ``corners``, shape (P, C), may reach into ``box``, into ``chosen``; how many."""
    count = 0
    for k in range(corners.shape[0]):
        meets = True
        for axis in range(3):
            low, high = boxes[corners[k, 0], axis], boxes[corners[k, 0], axis + 3]
            for c in range(1, corners.shape[1]):
                low, high = min(low, boxes[corners[k, c], axis]), max(high, boxes[corners[k, c], axis + 3])
            meets &= (low <= box[axis + 3]) & (high >= box[axis])
        chosen[count] = k
        count += meets
    return count


@compiled
def list_around(i, off, dt, corners, edges, watch):
    """Let particle i, ``off`` [m] its path, leave it farther, and add what it could meet; False if there is no room."""
    x, v, allowed, boxes, counts = watch.listed, watch.foreseen, watch.allowed, watch.boxes, watch.counts
    bodies, ways, normals = watch.bodies, watch.ways, watch.normals
    horizon, last = np.float32(counts[3]) * dt, bodies.shape[0] - 1
    allowed[i] = np.float32(WIDER) * off
    _reach(watch, i, horizon)
    own, around = np.empty(6, np.float32), boxes[i].copy()
    near = np.empty(max(x.shape[0], max(corners.shape[0], edges.shape[0])) + 1, np.int32)
    found = _around(boxes, corners, boxes[i], near)
    if counts[0] + counts[1] + found > last:
        return False
    for n in range(found):
        counts[0] += _enter_vertex(x, v, allowed, horizon, i, corners, near[n], bodies, ways, normals, counts[0])
    for t in range(corners.shape[0]):
        if i in (corners[t, 0], corners[t, 1], corners[t, 2]):
            for axis in range(6):
                own[axis] = boxes[i, axis]
            for c in range(3):
                _grow(own, boxes[corners[t, c]])
            _grow(around, own)
            for j in range(x.shape[0]):
                if _meet(own, boxes[j]):
                    if counts[0] + counts[1] > last:
                        return False
                    counts[0] += _enter_vertex(x, v, allowed, horizon, j, corners, t, bodies, ways, normals, counts[0])
    found = _around(boxes, edges, around, near)
    for e in range(edges.shape[0]):
        if i in (edges[e, 0], edges[e, 1]):
            if counts[0] + counts[1] + found > last:
                return False
            for n in range(found):
                place = last - counts[1]
                counts[1] += _enter_edges(x, v, allowed, horizon, edges, e, near[n], bodies, ways, normals, place)
    return True
