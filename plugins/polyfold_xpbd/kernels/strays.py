"""Particles that leave the path on which near pairs were listed.

In crumpled cloth hardly a substep passes without one, and thousands go on as foreseen: only pairs of those that strayed
are listed anew.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

SOON = 0.5
"""What is off its path by this share of what is allowed counts as strayed, too, once anything has."""
MOST_STRAYS = 128
"""If more stray at once, all pairs are listed anew."""


@compiled
def strays(x, listed, foreseen, elapsed, limit):
    """Whether a particle is more than ``limit`` [m] off where it was foreseen ``elapsed`` [s] after ``listed``."""
    for i in range(x.shape[0]):
        dx = x[i, 0] - listed[i, 0] - elapsed * foreseen[i, 0]
        dy = x[i, 1] - listed[i, 1] - elapsed * foreseen[i, 1]
        dz = x[i, 2] - listed[i, 2] - elapsed * foreseen[i, 2]
        if dx * dx + dy * dy + dz * dz > limit * limit:
            return True
    return False


@compiled
def redirect(x, v, listed, foreseen, elapsed, limit, stray):
    """Foresee a new path for what strayed; how many particles, or -1 if they are too many.

    Args:
        x, v: positions [m] and velocities [m/s], shape (N, 3).
        listed, foreseen: where each was when pairs were listed [m], and its velocity [m/s], shape (N, 3), changed.
        elapsed: time since then [s].
        limit: what is farther from its path strayed [m].
        stray: gets the number of each among those that strayed, -1 for all others, shape (N,).
    """
    count, near = 0, np.float32(SOON) * limit
    for i in range(x.shape[0]):
        dx = x[i, 0] - listed[i, 0] - elapsed * foreseen[i, 0]
        dy = x[i, 1] - listed[i, 1] - elapsed * foreseen[i, 1]
        dz = x[i, 2] - listed[i, 2] - elapsed * foreseen[i, 2]
        stray[i] = -1
        if dx * dx + dy * dy + dz * dz > near * near:
            if count == MOST_STRAYS:
                return -1
            stray[i] = count
            count += 1
            for axis in range(3):
                foreseen[i, axis] = v[i, axis]
                listed[i, axis] = x[i, axis] - elapsed * v[i, axis]
    return count


@compiled
def mark_around(x, v, horizon, reach, wide, corners, edges, stray, count, vertices_again, edges_again, close):
    """Mark vertices that may come within ``reach`` [m] of a triangle of a stray, the strays' edges, and what is close.

    Args:
        x, v: positions [m] and foreseen velocities [m/s], shape (N, 3).
        horizon: how far ahead [s].
        wide: no triangle is wider [m].
        corners, edges: vertices of triangles, shape (T, 3), and ends of edges, shape (E, 2).
        stray, count: see :func:`redirect`.
        vertices_again, edges_again: get the marks, bool, shapes (N,) and (E,).
        close: gets whether a particle's triangles may come near any of these, bool, shape (N,).
    """
    boxes = np.empty((count, 6), np.float32)
    boxes[:, :3], boxes[:, 3:] = np.float32(1e9), np.float32(-1e9)
    for t in range(corners.shape[0]):
        for c in range(3):
            s = stray[corners[t, c]]
            if s >= 0:
                for other in range(3):
                    i = corners[t, other]
                    for axis in range(3):
                        here = x[i, axis]
                        there = here + horizon * v[i, axis]
                        boxes[s, axis] = min(boxes[s, axis], min(here, there) - reach)
                        boxes[s, axis + 3] = max(boxes[s, axis + 3], max(here, there) + reach)
    far = wide + reach
    low, high = np.empty(3, np.float32), np.empty(3, np.float32)
    for i in range(x.shape[0]):
        vertices_again[i], close[i] = stray[i] >= 0, stray[i] >= 0
        for axis in range(3):
            here = x[i, axis]
            there = here + horizon * v[i, axis]
            low[axis], high[axis] = min(here, there), max(here, there)
        for s in range(count):
            if low[0] > boxes[s, 3] + far or high[0] < boxes[s, 0] - far:
                continue
            if low[1] > boxes[s, 4] + far or high[1] < boxes[s, 1] - far:
                continue
            if low[2] > boxes[s, 5] + far or high[2] < boxes[s, 2] - far:
                continue
            close[i] = True
            vertices_again[i] |= (
                (low[0] <= boxes[s, 3])
                & (high[0] >= boxes[s, 0])
                & (low[1] <= boxes[s, 4])
                & (high[1] >= boxes[s, 1])
                & (low[2] <= boxes[s, 5])
                & (high[2] >= boxes[s, 2])
            )
            if vertices_again[i]:
                break
    for e in range(edges.shape[0]):
        edges_again[e] = (stray[edges[e, 0]] >= 0) | (stray[edges[e, 1]] >= 0)
