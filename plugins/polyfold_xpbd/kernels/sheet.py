"""What holds the sheet together: bending, stretch and tethers."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled, shift


@compiled
def bend(x, v, hinges, weights, dt):
    """Change velocities by isometric bending over one step of ``dt`` [s].

    Args:
        x, v: positions [m] and velocities [m/s], shape (N, 3); ``v`` is changed.
        hinges, weights: particles and curvature stencil [1/s] of every hinge, shape (H, 4).
        dt: the step [s].
    """
    for h in range(hinges.shape[0]):
        a, b, c, d = hinges[h, 0], hinges[h, 1], hinges[h, 2], hinges[h, 3]
        wa, wb, wc, wd = weights[h, 0], weights[h, 1], weights[h, 2], weights[h, 3]
        kx = (wa * x[a, 0] + wb * x[b, 0] + wc * x[c, 0] + wd * x[d, 0]) * dt
        ky = (wa * x[a, 1] + wb * x[b, 1] + wc * x[c, 1] + wd * x[d, 1]) * dt
        kz = (wa * x[a, 2] + wb * x[b, 2] + wc * x[c, 2] + wd * x[d, 2]) * dt
        shift(v, a, -wa, kx, ky, kz)
        shift(v, b, -wb, kx, ky, kz)
        shift(v, c, -wc, kx, ky, kz)
        shift(v, d, -wd, kx, ky, kz)


@compiled
def stretch(x, mobility, edges, rest_lengths):
    """Move the ends of every edge to its rest length, one after another.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: 0 for held particles and 1 for free ones, shape (N,).
        edges: pairs of particles, shape (E, 2).
        rest_lengths: [m], shape (E,).
    """
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        length = np.sqrt(dx * dx + dy * dy + dz * dz) + np.float32(1e-12)
        wa, wb = mobility[a], mobility[b]
        s = (length - rest_lengths[e]) / (length * (wa + wb + np.float32(1e-12)))
        sa, sb = s * wa, s * wb
        shift(x, a, sa, dx, dy, dz)
        shift(x, b, -sb, dx, dy, dz)


@compiled
def hold_back(x, mobility, particles, anchors, lengths):
    """Move free particles back to where their tethers reach.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: 0 for held particles and 1 for free ones, shape (N,).
        particles, anchors: the two ends of every tether, shape (K,).
        lengths: the most that they may be apart [m], shape (K,).
    """
    for t in range(particles.shape[0]):
        i, a = particles[t], anchors[t]
        dx, dy, dz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
        d2 = dx * dx + dy * dy + dz * dz
        if d2 > lengths[t] * lengths[t] and mobility[i] > np.float32(0.0):
            s = np.float32(1.0) - lengths[t] / np.sqrt(d2)
            shift(x, i, -s, dx, dy, dz)
