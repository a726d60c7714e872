"""Shortest ways between a vertex and a triangle, and between two edges.

In double precision: the way between edges that are nearly parallel is worth nothing in single.
"""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

TINY = 1e-30


@compiled
def _way(x, a, b):
    """From particle a to particle b [m]."""
    return (
        np.float64(x[b, 0]) - np.float64(x[a, 0]),
        np.float64(x[b, 1]) - np.float64(x[a, 1]),
        np.float64(x[b, 2]) - np.float64(x[a, 2]),
    )


@compiled
def _dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


@compiled
def _clamped(value):
    return min(max(value, 0.0), 1.0)


@compiled
def from_triangle(x, i, a, b, c):
    """The shortest way [m] from triangle a-b-c to vertex i, three components (cf. Ericson 2005, section 5.1.5)."""
    u, w, r = _way(x, a, b), _way(x, a, c), _way(x, a, i)
    uu, ww, uw, ur, wr = _dot(u, u), _dot(w, w), _dot(u, w), _dot(u, r), _dot(w, r)
    square = uu * ww - uw * uw
    beta, gamma = ur * ww - wr * uw, wr * uu - ur * uw
    if min(beta, gamma) >= 0.0 and beta + gamma <= square and square > 0.0:
        beta, gamma = beta / square, gamma / square
    else:
        # Nearest on the rim: on the best of the three sides.
        s, t = _clamped(ur / (uu + TINY)), _clamped(wr / (ww + TINY))
        e, q = _way(x, b, c), _way(x, b, i)
        p = _clamped(_dot(e, q) / (_dot(e, e) + TINY))
        least = 1e30
        for b_share, c_share in ((s, 0.0), (0.0, t), (1.0 - p, p)):
            dx = r[0] - b_share * u[0] - c_share * w[0]
            dy = r[1] - b_share * u[1] - c_share * w[1]
            dz = r[2] - b_share * u[2] - c_share * w[2]
            if dx * dx + dy * dy + dz * dz < least:
                least, beta, gamma = dx * dx + dy * dy + dz * dz, b_share, c_share
    return (
        r[0] - beta * u[0] - gamma * w[0],
        r[1] - beta * u[1] - gamma * w[1],
        r[2] - beta * u[2] - gamma * w[2],
    )


@compiled
def between_edges(x, a, b, c, d):
    """The shortest way [m] from edge c-d to edge a-b, three components (cf. Ericson 2005, section 5.1.9)."""
    u, w, r = _way(x, a, b), _way(x, c, d), _way(x, c, a)
    uu, ww, uw, ur, wr = _dot(u, u), _dot(w, w), _dot(u, w), _dot(u, r), _dot(w, r)
    square = uu * ww - uw * uw
    # Along parallel edges any point of the first is as good as another to begin with.
    s = _clamped((uw * wr - ur * ww) / square) if square > 1e-12 * uu * ww else 0.0
    t = (uw * s + wr) / (ww + TINY)
    if t < 0.0 or t > 1.0:
        t = _clamped(t)
        s = _clamped((t * uw - ur) / (uu + TINY))
    return r[0] + s * u[0] - t * w[0], r[1] + s * u[1] - t * w[1], r[2] + s * u[2] - t * w[2]
