"""What holds the sheet together: bending with creases that stay, stretch and tethers."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled, shift


@compiled
def bend(x, v, mobility, ahead, hinges, weights, rest, lead, dt):
    """Change velocities by isometric bending over one step of ``dt`` [s].

    Args:
        x, v: positions [m] and velocities [m/s], shape (N, 3); ``v`` is changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        hinges, weights: particles and curvature stencil [1/s] of every hinge, shape (H, 4).
        rest: what the stencil gives where the hinge is free of moment [m/s], shape (H, 3).
        dt: the step [s].
    """
    for i in range(x.shape[0]):
        for axis in range(3):
            ahead[i, axis] = x[i, axis] + lead * v[i, axis]
    for h in range(hinges.shape[0]):
        a, b, c, d = hinges[h, 0], hinges[h, 1], hinges[h, 2], hinges[h, 3]
        wa, wb, wc, wd = weights[h, 0], weights[h, 1], weights[h, 2], weights[h, 3]
        kx = (wa * ahead[a, 0] + wb * ahead[b, 0] + wc * ahead[c, 0] + wd * ahead[d, 0] - rest[h, 0]) * dt
        ky = (wa * ahead[a, 1] + wb * ahead[b, 1] + wc * ahead[c, 1] + wd * ahead[d, 1] - rest[h, 1]) * dt
        kz = (wa * ahead[a, 2] + wb * ahead[b, 2] + wc * ahead[c, 2] + wd * ahead[d, 2] - rest[h, 2]) * dt
        shift(v, a, -wa * mobility[a], kx, ky, kz)
        shift(v, b, -wb * mobility[b], kx, ky, kz)
        shift(v, c, -wc * mobility[c], kx, ky, kz)
        shift(v, d, -wd * mobility[d], kx, ky, kz)


@compiled
def crease(x, hinges, weights, elastic, share, set_curvature, rest):
    """Let hinges bent beyond what is elastic take a set, and turn the rest curvature with the sheet.

    An elastic part in parallel with one that yields (linear kinematic hardening): beyond ``elastic`` the plastic
    curvature follows, and ``share`` of it stays when the moment is gone.

    Args:
        x: positions [m], shape (N, 3).
        hinges, weights: as in :func:`bend`.
        elastic: the stencil's length [m/s] up to which a hinge is elastic, shape (H,).
        share: of the plastic curvature that stays.
        set_curvature: plastic curvature as the stencil's signed length [m/s], shape (H,), changed.
        rest: gets the rest curvature as a vector, shape (H, 3).
    """
    zero = np.float32(0.0)
    for h in range(hinges.shape[0]):
        a, b, c, d = hinges[h, 0], hinges[h, 1], hinges[h, 2], hinges[h, 3]
        wa, wb, wc, wd = weights[h, 0], weights[h, 1], weights[h, 2], weights[h, 3]
        kx = wa * x[a, 0] + wb * x[b, 0] + wc * x[c, 0] + wd * x[d, 0]
        ky = wa * x[a, 1] + wb * x[b, 1] + wc * x[c, 1] + wd * x[d, 1]
        kz = wa * x[a, 2] + wb * x[b, 2] + wc * x[c, 2] + wd * x[d, 2]
        bent_2 = kx * kx + ky * ky + kz * kz
        if set_curvature[h] == zero and bent_2 < elastic[h] * elastic[h]:
            continue
        ex, ey, ez = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        # The sum of both triangles' normals is the edge crossed with the way from one far corner to the other.
        fx, fy, fz = x[c, 0] - x[d, 0], x[c, 1] - x[d, 1], x[c, 2] - x[d, 2]
        nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
        along = nx * kx + ny * ky + nz * kz
        normal_2 = nx * nx + ny * ny + nz * nz
        if along * along > np.float32(0.5) * bent_2 * normal_2 or bent_2 > np.float32(4.0) * elastic[h] * elastic[h]:
            # Bent clearly: the stencil itself says which way, also where the sheet lies folded on itself.
            sign = np.float32(1.0) if along >= zero else np.float32(-1.0)
            scale = sign / np.sqrt(bent_2 + np.float32(1e-20))
            ux, uy, uz = kx * scale, ky * scale, kz * scale
        else:
            scale = np.float32(1.0) / np.sqrt(normal_2 + np.float32(1e-20))
            ux, uy, uz = nx * scale, ny * scale, nz * scale
        bent = kx * ux + ky * uy + kz * uz
        if bent - set_curvature[h] > elastic[h]:
            set_curvature[h] = bent - elastic[h]
        elif bent - set_curvature[h] < -elastic[h]:
            set_curvature[h] = bent + elastic[h]
        kept = share * set_curvature[h]
        rest[h, 0], rest[h, 1], rest[h, 2] = kept * ux, kept * uy, kept * uz


@compiled
def stretch(x, mobility, edges, rest_lengths):
    """Move the ends of every edge to its rest length, one after another.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
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
def limit_strain(x, mobility, edges, rest_lengths, most, sweeps):
    """Draw together the ends of edges that are stretched by more than ``most``, until none is, or so many times.

    One sweep of :func:`stretch` leaves cloth soft where a grip drags all of it. Where nothing does, no edge is touched.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        edges: pairs of particles, shape (E, 2).
        rest_lengths: [m], shape (E,).
        most: the largest strain that an edge keeps.
        sweeps: how often all edges are looked at, at most.
    """
    longest = np.float32(1.0) + most
    for _ in range(sweeps):
        over = False
        for e in range(edges.shape[0]):
            a, b = edges[e, 0], edges[e, 1]
            dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
            length_2, bound = dx * dx + dy * dy + dz * dz, longest * rest_lengths[e]
            weight = mobility[a] + mobility[b]
            if length_2 > bound * bound and weight > np.float32(0.0):
                over = True
                s = (np.float32(1.0) - bound / np.sqrt(length_2)) / weight
                shift(x, a, s * mobility[a], dx, dy, dz)
                shift(x, b, -s * mobility[b], dx, dy, dz)
        if not over:
            break


@compiled
def let_go(x, mobility, lightness, edges, rest_lengths, most):
    """Free held particles at whose edges the cloth is stretched by more than ``most``: they slip out of the grip.

    Args:
        x: positions [m], shape (N, 3).
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,), changed.
        lightness: what they are where nothing is held, shape (N,).
        edges: pairs of particles, shape (E, 2).
        rest_lengths: [m], shape (E,).
        most: the largest strain that a grip bears.

    Returns:
        The largest strain of an edge, held or not.
    """
    zero, one = np.float32(0.0), np.float32(1.0)
    longest, largest = (one + most) * (one + most), zero
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        share_2 = (dx * dx + dy * dy + dz * dz) / (rest_lengths[e] * rest_lengths[e])
        largest = max(largest, share_2)
        if share_2 > longest and (mobility[a] == zero or mobility[b] == zero):
            mobility[a], mobility[b] = lightness[a], lightness[b]
    return np.sqrt(largest) - one


@compiled
def hold_back(x, mobility, particles, anchors, lengths):
    """Move free particles back to where their tethers reach, of which the anchors are held.

    Args:
        x: positions [m], shape (N, 3), changed.
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        particles, anchors: the two ends of every tether, shape (K,).
        lengths: the most that they may be apart [m], shape (K,).
    """
    for t in range(particles.shape[0]):
        i, a = particles[t], anchors[t]
        dx, dy, dz = x[i, 0] - x[a, 0], x[i, 1] - x[a, 1], x[i, 2] - x[a, 2]
        d2 = dx * dx + dy * dy + dz * dz
        held = mobility[a] == np.float32(0.0) and mobility[i] > np.float32(0.0)
        if held and d2 > lengths[t] * lengths[t]:
            s = np.float32(1.0) - lengths[t] / np.sqrt(d2)
            shift(x, i, -s, dx, dy, dz)
