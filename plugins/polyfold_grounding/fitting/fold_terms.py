"""Compiled silhouette of one more fold, with derivatives; imported only when something is fitted.

The silhouette after a fold depends only on the silhouette before it and the line: its boundary is made of those old
boundary points, mirrored if they were left of the line, whose mirror image lies outside the old silhouette, and of the
crease's edge. So a fold line can be optimised without replaying the folds.

Parameters: shift x, y [px], turn [rad] about ``centre``, then the line's offset to its left [px] and turn [rad] about
``pivot``, and how far to the right of the line the crease's edge lies [px], half the fold's allowance.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from polyfold_grounding.fitting.contour_terms import field_at

__all__ = ["fold_normal_equations", "folded_boundary"]


@njit(cache=True)
def _inside(polygon, x, y):
    odd = False
    j = len(polygon) - 1
    for i in range(len(polygon)):
        if (polygon[i, 1] > y) != (polygon[j, 1] > y):
            share = (y - polygon[i, 1]) / (polygon[j, 1] - polygon[i, 1])
            if x < polygon[i, 0] + share * (polygon[j, 0] - polygon[i, 0]):
                odd = not odd
        j = i
    return odd


@njit(cache=True)
def folded_boundary(boundary, outline, centre, pivot, angle, parameters):
    """Boundary points after the fold and the motion, their derivatives, and which join the one before them.

    Args:
        boundary: evenly spaced points of the old silhouette [px], shape (N, 2).
        outline: the old silhouette as a polygon [px], shape (M, 2).
        centre, pivot: centres of turn [px], shape (2,).
        angle: direction of the planned line [rad].
        parameters: shape (6,).

    Returns:
        Points, shape (K, 2); derivatives, shape (K, 2, 6); joined, bool, shape (K,).
    """
    tx, ty, turn, offset, bend, inset = parameters
    c, s = np.cos(turn), np.sin(turn)
    dx, dy = np.cos(angle + bend), np.sin(angle + bend)
    nx, ny = dy, -dx
    count = len(boundary)
    spacing = np.hypot(boundary[1, 0] - boundary[0, 0], boundary[1, 1] - boundary[0, 1])
    reach = 0.0
    for i in range(len(outline)):
        reach = max(reach, np.hypot(outline[i, 0] - pivot[0], outline[i, 1] - pivot[1]))
    steps = int(2 * reach / max(spacing, 0.5)) + 1
    room = count + steps
    points, slopes = np.empty((room, 2)), np.zeros((room, 2, 6))
    joined = np.zeros(room, np.bool_)
    used, last, last_left = 0, -2, False
    for i in range(count):
        px, py = boundary[i, 0] - pivot[0], boundary[i, 1] - pivot[1]
        height = nx * px + ny * py - offset
        along = dx * px + dy * py
        mx, my = boundary[i, 0] - 2 * height * nx, boundary[i, 1] - 2 * height * ny
        left = height > 0
        if abs(height) < inset or _inside(outline, mx, my):
            continue
        if left:
            points[used, 0], points[used, 1] = mx, my
            slopes[used, 0, 3], slopes[used, 1, 3] = 2 * nx, 2 * ny
            slopes[used, 0, 4] = -2 * (along * nx + height * dx)
            slopes[used, 1, 4] = -2 * (along * ny + height * dy)
        else:
            points[used, 0], points[used, 1] = boundary[i, 0], boundary[i, 1]
        joined[used] = last == i - 1 and last_left == left
        last, last_left = i, left
        used += 1
    previous = False
    ox, oy = pivot[0] + (offset - inset) * nx, pivot[1] + (offset - inset) * ny
    for k in range(steps):
        t = -reach + k * spacing
        x, y = ox + t * dx, oy + t * dy
        inside = _inside(outline, x, y) or _inside(outline, x + 2 * inset * nx, y + 2 * inset * ny)
        if inside and used < room:
            points[used, 0], points[used, 1] = x, y
            slopes[used, 0, 3], slopes[used, 1, 3] = nx, ny
            across = offset - inset
            slopes[used, 0, 4], slopes[used, 1, 4] = across * dx - t * nx, across * dy - t * ny
            slopes[used, 0, 5], slopes[used, 1, 5] = -nx, -ny
            joined[used] = previous
            used += 1
            previous = True
        else:
            previous = False
    for k in range(used):
        x, y = points[k, 0] - centre[0], points[k, 1] - centre[1]
        points[k, 0], points[k, 1] = c * x - s * y + centre[0] + tx, s * x + c * y + centre[1] + ty
        for j in (3, 4, 5):
            a, b = slopes[k, 0, j], slopes[k, 1, j]
            slopes[k, 0, j], slopes[k, 1, j] = c * a - s * b, s * a + c * b
        slopes[k, 0, 0] = slopes[k, 1, 1] = 1.0
        slopes[k, 0, 2], slopes[k, 1, 2] = -s * x - c * y, c * x - s * y
    return points[:used], slopes[:used], joined[:used]


@njit(cache=True)
def fold_normal_equations(boundary, outline, centre, pivot, angle, parameters, samples, field, margin, delta):
    """Mean pseudo-Huber cost [px²], Chamfer distance [px], gradient, shape (6,), and Hessian, shape (6, 6)."""
    points, slopes, joined = folded_boundary(boundary, outline, centre, pivot, angle, parameters)
    gradient, hessian, slope = np.zeros(6), np.zeros((6, 6)), np.zeros(6)
    cost = chamfer = 0.0
    count = len(points)
    if count == 0:
        return 1e12, 1e6, gradient, hessian
    for k in range(count):
        r, gx, gy = field_at(field, points[k, 0] + margin, points[k, 1] + margin)
        root = np.sqrt(1 + (r / delta) ** 2)
        cost += 0.5 * delta * delta * (root - 1) / count
        chamfer += 0.5 * abs(r) / count
        for j in range(6):
            slope[j] = gx * slopes[k, 0, j] + gy * slopes[k, 1, j]
        _accumulate(gradient, hessian, slope, r, 0.5 / (root * count))
    for i in range(len(samples)):
        x, y = samples[i, 0], samples[i, 1]
        best, at, share = 1e300, 0, 0.0
        for k in range(count):
            ux, uy = x - points[k, 0], y - points[k, 1]
            d2, part = ux * ux + uy * uy, 0.0
            if joined[k]:
                vx, vy = points[k - 1, 0] - points[k, 0], points[k - 1, 1] - points[k, 1]
                part = min(max((ux * vx + uy * vy) / max(vx * vx + vy * vy, 1e-9), 0.0), 1.0)
                ux, uy = ux - part * vx, uy - part * vy
                d2 = ux * ux + uy * uy
            if d2 < best:
                best, at, share = d2, k, part
        d = np.sqrt(best)
        chamfer += 0.5 * d / len(samples)
        root = np.sqrt(1 + best / delta**2)
        cost += 0.5 * delta * delta * (root - 1) / len(samples)
        if d < 1e-6:
            continue
        before = at - 1 if share > 0 else at
        px = (1 - share) * points[at, 0] + share * points[before, 0]
        py = (1 - share) * points[at, 1] + share * points[before, 1]
        nx, ny = (px - x) / d, (py - y) / d
        for j in range(6):
            slope[j] = nx * ((1 - share) * slopes[at, 0, j] + share * slopes[before, 0, j])
            slope[j] += ny * ((1 - share) * slopes[at, 1, j] + share * slopes[before, 1, j])
        _accumulate(gradient, hessian, slope, d, 0.5 / (root * len(samples)))
    return cost, chamfer, gradient, hessian


@njit(cache=True)
def _accumulate(gradient, hessian, slope, residual, weight):
    for i in range(6):
        gradient[i] += weight * residual * slope[i]
        for j in range(6):
            hessian[i, j] += weight * slope[i] * slope[j]
