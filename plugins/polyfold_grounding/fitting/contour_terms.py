"""Compiled terms of the contour energy and their normal equations; imported only when something is fitted."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["contour_cost", "contour_normal_equations", "field_at"]

COVERED = 0.05
"""Weight of a distance inside the cloth for edges that other cloth may cover."""


@njit(cache=True)
def field_at(field, x, y):
    """Bilinear value and gradient of a field at array coordinates; beyond the border it goes on linearly."""
    height, width = field.shape
    inner_x = min(max(x, 0.0), width - 1.001)
    inner_y = min(max(y, 0.0), height - 1.001)
    i, j = int(inner_y), int(inner_x)
    fy, fx = inner_y - i, inner_x - j
    a, b, c, d = field[i, j], field[i, j + 1], field[i + 1, j], field[i + 1, j + 1]
    value = (a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy
    gx = (b - a) * (1 - fy) + (d - c) * fy
    gy = (c - a) * (1 - fx) + (d - b) * fx
    dx, dy = x - inner_x, y - inner_y
    return value + abs(dx) + abs(dy), gx + np.sign(dx), gy + np.sign(dy)


@njit(cache=True)
def _edge_lengths(vertices):
    count = len(vertices)
    lengths = np.empty(count)
    for e in range(count):
        f = (e + 1) % count
        lengths[e] = np.hypot(vertices[f, 0] - vertices[e, 0], vertices[f, 1] - vertices[e, 1])
    return lengths


@njit(cache=True)
def _closest(vertices, x, y):
    """Edge, share along it and squared distance of the point of the polygon nearest to (x, y)."""
    count = len(vertices)
    best, best_edge, best_share = 1e300, 0, 0.0
    for e in range(count):
        f = (e + 1) % count
        ax, ay = vertices[e, 0], vertices[e, 1]
        ux, uy = vertices[f, 0] - ax, vertices[f, 1] - ay
        share = ((x - ax) * ux + (y - ay) * uy) / max(ux * ux + uy * uy, 1e-9)
        share = min(max(share, 0.0), 1.0)
        dx, dy = x - ax - share * ux, y - ay - share * uy
        d = dx * dx + dy * dy
        if d < best:
            best, best_edge, best_share = d, e, share
    return best_edge, best_share, best


@njit(cache=True)
def _spread(lengths, count):
    """``count`` points evenly along a closed polygon: the edge that each lies on and its share of that edge."""
    edges, shares = np.empty(count, np.int64), np.empty(count)
    spacing = lengths.sum() / count
    position = 0.5 * spacing
    e = 0
    for k in range(count):
        while position > lengths[e] and e < len(lengths) - 1:
            position -= lengths[e]
            e += 1
        edges[k], shares[k] = e, min(position / max(lengths[e], 1e-9), 1.0)
        position += spacing
    return edges, shares


@njit(cache=True)
def contour_cost(vertices, covered, samples, field, margin, delta, count):
    """Mean pseudo-Huber cost [px²] and mean distance [px], each half model to cloth and half cloth to model."""
    lengths = _edge_lengths(vertices)
    edges, shares = _spread(lengths, count)
    cost = chamfer = 0.0
    for k in range(count):
        e, share = edges[k], shares[k]
        f = (e + 1) % len(lengths)
        x = vertices[e, 0] + share * (vertices[f, 0] - vertices[e, 0])
        y = vertices[e, 1] + share * (vertices[f, 1] - vertices[e, 1])
        r, _, _ = field_at(field, x + margin, y + margin)
        if covered[e] and r < 0:
            r *= COVERED
        cost += delta * delta * (np.sqrt(1 + (r / delta) ** 2) - 1) / count
        chamfer += abs(r) / count
    for k in range(len(samples)):
        _, _, d2 = _closest(vertices, samples[k, 0], samples[k, 1])
        cost += delta * delta * (np.sqrt(1 + d2 / delta**2) - 1) / len(samples)
        chamfer += np.sqrt(d2) / len(samples)
    return 0.5 * cost, 0.5 * chamfer


@njit(cache=True)
def _add(gradient, hessian, e, f, share, nx, ny, r, weight):
    """Add one residual whose derivative is (1 - share) n at vertex e and share n at vertex f."""
    a, b = 1.0 - share, share
    gradient[2 * e] += weight * r * a * nx
    gradient[2 * e + 1] += weight * r * a * ny
    gradient[2 * f] += weight * r * b * nx
    gradient[2 * f + 1] += weight * r * b * ny
    index = (2 * e, 2 * e + 1, 2 * f, 2 * f + 1)
    slope = (a * nx, a * ny, b * nx, b * ny)
    for i in range(4):
        for j in range(4):
            hessian[index[i], index[j]] += weight * slope[i] * slope[j]


@njit(cache=True)
def contour_normal_equations(vertices, covered, samples, field, margin, delta, count):
    """Cost as :func:`contour_cost`, with its gradient, shape (2V,), and Gauss-Newton Hessian, shape (2V, 2V)."""
    lengths = _edge_lengths(vertices)
    size = 2 * len(vertices)
    gradient, hessian = np.zeros(size), np.zeros((size, size))
    edges, shares = _spread(lengths, count)
    cost = 0.0
    for k in range(count):
        e, share = edges[k], shares[k]
        f = (e + 1) % len(lengths)
        x = vertices[e, 0] + share * (vertices[f, 0] - vertices[e, 0])
        y = vertices[e, 1] + share * (vertices[f, 1] - vertices[e, 1])
        r, gx, gy = field_at(field, x + margin, y + margin)
        if covered[e] and r < 0:
            r, gx, gy = COVERED * r, COVERED * gx, COVERED * gy
        root = np.sqrt(1 + (r / delta) ** 2)
        cost += 0.5 * delta * delta * (root - 1) / count
        _add(gradient, hessian, e, f, share, gx, gy, r, 0.5 / (root * count))
    for k in range(len(samples)):
        x, y = samples[k, 0], samples[k, 1]
        e, share, d2 = _closest(vertices, x, y)
        f = (e + 1) % len(lengths)
        d = np.sqrt(d2)
        if d > 1e-6:
            nx = (vertices[e, 0] + share * (vertices[f, 0] - vertices[e, 0]) - x) / d
            ny = (vertices[e, 1] + share * (vertices[f, 1] - vertices[e, 1]) - y) / d
        else:
            nx = -(vertices[f, 1] - vertices[e, 1]) / max(lengths[e], 1e-9)
            ny = (vertices[f, 0] - vertices[e, 0]) / max(lengths[e], 1e-9)
        root = np.sqrt(1 + d2 / delta**2)
        cost += 0.5 * delta * delta * (root - 1) / len(samples)
        _add(gradient, hessian, e, f, share, nx, ny, d, 0.5 / (root * len(samples)))
    return cost, gradient, hessian
