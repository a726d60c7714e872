"""The guarantee: no substep ends with cloth having passed through cloth.

Two convex bodies that a plane parts at the start of a straight motion and at its end are apart all the time between, if
the plane's normal is the same. So for every vertex and triangle, and for all pairs of edges, that could meet, a normal
is kept that parts them. Where the end of a substep leaves none, the particles are moved back to either side, and what
does not come apart so in a few sweeps moves as one for this substep: by its mean, or as the grippers do that hold some
of it, but never into the table. A gripper that would have to pull cloth through cloth lags behind its path.

After Offset Geometric Contact (Chen et al. 2025, doi 10.1145/3731205), which bounds every particle's way by its
distance to others; planes don't hold back a packet that is carried as a whole. What moves as one is an impact zone
(Provot 1997, doi 10.1007/978-3-7091-6874-5_13; Bridson et al. 2002, doi 10.1145/566654.566623) that doesn't turn.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.guarantee.close import MOST_STRAYS, list_around, list_close
from polyfold_xpbd.kernels.guarantee.distance import TINY, between_edges, from_triangle
from polyfold_xpbd.kernels.vectors import compiled, copy_rows

APART, FARTHER = 0.1, 0.01
"""Bodies are kept this far apart, in thicknesses, unless they were nearer before; then they part by so much more."""
SWEEPS = 8
"""Sweeps that move particles to either side of planes; what then still meets moves as one."""
ATTEMPTS = 4
"""How often what was moved back may leave what is listed in one substep; then, or without room, nothing moves in it."""


@compiled
def _gap(x, bodies, p, upper, nx, ny, nz):
    """How far the first ``upper`` particles of pair p are above the others along a normal [m]."""
    o = bodies[p, 0]
    lowest, highest = np.float32(1e9), np.float32(-1e9)
    for m in range(4):
        i = bodies[p, m]
        along = nx * (x[i, 0] - x[o, 0]) + ny * (x[i, 1] - x[o, 1]) + nz * (x[i, 2] - x[o, 2])
        if m < upper:
            lowest = min(lowest, along)
        else:
            highest = max(highest, along)
    return lowest - highest


@compiled
def _part(x, bodies, p, upper, nx, ny, nz, missing, floor, mobility, moved, sweep):
    """Move the particles of pair p along the normal until they are ``missing`` [m] farther apart, or on the table."""
    zero, half = np.float32(0.0), np.float32(0.5)
    o = bodies[p, 0]
    ox, oy, oz = x[o, 0], x[o, 1], x[o, 2]
    above, below = zero, zero
    lowest, highest = np.float32(1e9), np.float32(-1e9)
    for m in range(4):
        i = bodies[p, m]
        along = nx * (x[i, 0] - ox) + ny * (x[i, 1] - oy) + nz * (x[i, 2] - oz)
        if m < upper:
            lowest, above = min(lowest, along), max(above, mobility[i])
        else:
            highest, below = max(highest, along), max(below, mobility[i])
    share = above / (above + below) if above + below > zero else half
    rise, fall = lowest + share * missing, highest - (np.float32(1.0) - share) * missing
    for m in range(4):
        i = bodies[p, m]
        along = nx * (x[i, 0] - ox) + ny * (x[i, 1] - oy) + nz * (x[i, 2] - oz)
        way = max(zero, rise - along) if m < upper else min(zero, fall - along)
        if way != zero:
            x[i, 0], x[i, 1] = x[i, 0] + way * nx, x[i, 1] + way * ny
            x[i, 2] = max(x[i, 2] + way * nz, min(x[i, 2], floor))
            moved[i] = sweep


@compiled
def _root(zones, i):
    """The first particle of the zone that particle i is in."""
    while zones[i] != i:
        zones[i] = zones[zones[i]]
        i = zones[i]
    return i


@compiled
def _unite(zones, a, b, c, d):
    """Put four particles into one zone; whether they were not."""
    root, apart = _root(zones, a), False
    for i in (b, c, d):
        other = _root(zones, i)
        if other != root:
            zones[other], apart = root, True
    return apart


@compiled
def _may_meet(watch, p, upper, after, apart):
    """Whether what pair p strayed lets it come near ``apart`` [m] at ``after`` [s] since it was listed."""
    bodies, off = watch.bodies, watch.off
    a, b, c, d = bodies[p, 0], bodies[p, 1], bodies[p, 2], bodies[p, 3]
    if upper == 1:
        strayed = off[a] + max(off[b], max(off[c], off[d]))
    else:
        strayed = max(off[a], off[b]) + max(off[c], off[d])
    return watch.ways[p, 0] - after * watch.ways[p, 1] - strayed < apart


@compiled
def _sweep(x, start, first, last, upper, watch, after, apart, floor, mobility, sweep):
    """Part pairs ``first`` to ``last`` of which a particle was moved lately, or unite them in zones; how many met."""
    close, met = np.float32(0.5) * apart, 0
    bodies, normals, moved, zones = watch.bodies, watch.normals, watch.moved, watch.zones
    for p in range(first, last):
        a, b, c, d = bodies[p, 0], bodies[p, 1], bodies[p, 2], bodies[p, 3]
        if sweep == 1:
            if not _may_meet(watch, p, upper, after, apart):
                continue
        elif max(max(moved[a], moved[b]), max(moved[c], moved[d])) < sweep - 1:
            continue
        nx, ny, nz = normals[p, 0], normals[p, 1], normals[p, 2]
        if min(_gap(start, bodies, p, upper, nx, ny, nz), _gap(x, bodies, p, upper, nx, ny, nz)) > close:
            continue
        if upper == 1:
            wx, wy, wz = from_triangle(start, a, b, c, d)
        else:
            wx, wy, wz = between_edges(start, a, b, c, d)
        scale = 1.0 / np.sqrt(wx * wx + wy * wy + wz * wz + TINY)
        nx, ny, nz = np.float32(wx * scale), np.float32(wy * scale), np.float32(wz * scale)
        normals[p, 0], normals[p, 1], normals[p, 2] = nx, ny, nz
        need = min(apart, _gap(start, bodies, p, upper, nx, ny, nz))
        gap = _gap(x, bodies, p, upper, nx, ny, nz)
        if gap >= need:
            continue
        if sweep <= SWEEPS:
            missing = need - gap + np.float32(FARTHER) * apart
            _part(x, bodies, p, upper, nx, ny, nz, missing, floor, mobility, moved, sweep)
            met += 1
        else:
            # What is in one zone already moves alike but for rounding.
            met += _unite(zones, a, b, c, d)
    return met


@compiled
def _move_zones(x, start, floor, mobility, zones, sums, moved, sweep):
    """Let what is in a zone move as one.

    Args:
        x, start: positions [m], shape (N, 3), now, which are changed, and at the start of the substep.
        floor: no zone moves particles down that are lower [m], nor lower than that.
        mobility: inverse masses; 0 for held particles, shape (N,).
        zones: of each particle another of its zone, or itself, shape (N,).
        sums: overwritten, shape (N, 6).
        moved: gets the number of the ``sweep`` where particles were moved, shape (N,).
    """
    zero, one = np.float32(0.0), np.float32(1.0)
    sums[:, :], sums[:, 5] = zero, np.float32(-1e9)
    for i in range(x.shape[0]):
        root, held = _root(zones, i), mobility[i] == zero
        sums[root, 4] += one
        sums[root, 5] = max(sums[root, 5], min(zero, floor - start[i, 2]))
        # Where grippers hold some of it, only these count.
        if held and sums[root, 3] >= zero:
            sums[root, :4] = zero
        if held or sums[root, 3] >= zero:
            weight = one if held else one / mobility[i]
            for axis in range(3):
                sums[root, axis] += weight * (x[i, axis] - start[i, axis])
            sums[root, 3] += -one if held else weight
    for i in range(x.shape[0]):
        root = _root(zones, i)
        if sums[root, 4] > one:
            for axis in range(3):
                way = sums[root, axis] / abs(sums[root, 3])
                there = start[i, axis] + (way if axis < 2 else max(way, sums[root, 5]))
                if x[i, axis] != there:
                    x[i, axis], moved[i] = there, sweep


@compiled
def _part_all(x, start, after, apart, floor, mobility, watch):
    """Part all that is listed."""
    counts, last = watch.counts, watch.bodies.shape[0]
    watch.moved[:] = 0
    for i in range(x.shape[0]):
        watch.zones[i] = i
    sweep, met = 0, 1
    while met > 0:
        sweep += 1
        met = _sweep(x, start, 0, counts[0], 1, watch, after, apart, floor, mobility, sweep)
        met += _sweep(x, start, last - counts[1], last, 2, watch, after, apart, floor, mobility, sweep)
        if met > 0 and sweep > SWEEPS:
            _move_zones(x, start, floor, mobility, watch.zones, watch.sums, watch.moved, sweep)


@compiled
def _look(x, elapsed, watch):
    """Update how far particles at ``x`` are off their paths ``elapsed`` [s] after these were listed; how many stray."""
    listed, foreseen, off = watch.listed, watch.foreseen, watch.off
    count = 0
    for i in range(x.shape[0]):
        dx = x[i, 0] - listed[i, 0] - elapsed * foreseen[i, 0]
        dy = x[i, 1] - listed[i, 1] - elapsed * foreseen[i, 1]
        dz = x[i, 2] - listed[i, 2] - elapsed * foreseen[i, 2]
        off[i] = max(off[i], np.sqrt(dx * dx + dy * dy + dz * dz))
        count += off[i] > watch.allowed[i]
    return count


@compiled
def _follow(strays, dt, corners, edges, watch):
    """Add to the list what the strays may meet; whether it was possible."""
    if strays > MOST_STRAYS:
        return False
    for i in range(watch.off.shape[0]):
        if watch.off[i] > watch.allowed[i] and not list_around(i, watch.off[i], dt, corners, edges, watch):
            return False
    return True


@compiled
def keep_apart(x, start, dt, thickness, edge_length, corners, edges, mobility, watch):
    """Change the end ``x`` of a substep so that on the straight way from its ``start`` nothing passed through.

    Args:
        x, start: positions [m], shape (N, 3); all is apart at the start; ``x`` is changed.
        dt: the substep [s].
        thickness, edge_length: [m].
        corners, edges: vertices of triangles, shape (T, 3), and ends of edges, shape (E, 2).
        mobility: inverse masses; 0 for held particles, shape (N,).
        watch: what is close, changed.

    Returns:
        Whether there was room for what is close where nothing moves.
    """
    counts, apart, floor = watch.counts, np.float32(APART) * thickness, np.float32(0.5) * thickness
    old = counts[2] >= counts[3]
    for _ in range(ATTEMPTS):
        watch.off[:] = np.float32(0.0)
        if not old:
            strays = _look(start, np.float32(counts[2]) * dt, watch)
            strays = max(strays, _look(x, np.float32(counts[2] + 1) * dt, watch))
            old = strays > 0 and not _follow(strays, dt, corners, edges, watch)
        if old:
            if not list_close(x, start, dt, edge_length, corners, edges, watch):
                break
            watch.off[:], old = np.float32(0.0), False
        after = np.float32(counts[2] + 1) * dt
        _part_all(x, start, after, apart, floor, mobility, watch)
        if _look(x, after, watch) == 0:
            counts[2] += 1
            return True
    copy_rows(start, x)
    listed = list_close(x, start, dt, edge_length, corners, edges, watch)
    counts[2], counts[3] = 0, 0
    return listed
