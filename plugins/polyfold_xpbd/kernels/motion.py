"""Motion: free flight, the grippers, and the velocities that a substep ends with."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

BRAKE = 3.0
"""Dry friction inside the cloth, as a deceleration [m/s²]: what trembles comes to rest, what moves hardly feels it."""


@compiled
def damp(v, dt, damping):
    """Damp velocities [m/s], shape (N, 3), over ``dt`` [s], by ``damping`` [1/s] and by dry friction inside the cloth.

    Before gravity and bending act, and so neither is weakened against the other.
    """
    keep, brake = np.float32(1.0) - damping * dt, np.float32(BRAKE) * dt
    for i in range(v.shape[0]):
        speed = np.sqrt(v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2]) + np.float32(1e-12)
        left = keep * max(np.float32(0.0), np.float32(1.0) - brake / speed)
        v[i, 0], v[i, 1], v[i, 2] = v[i, 0] * left, v[i, 1] * left, v[i, 2] * left


@compiled
def predict(x, v, previous, start, mobility, dt, fastest):
    """Let free particles fly for ``dt`` [s] under gravity, no faster than ``fastest`` [m/s].

    Args:
        x, v: positions [m] and velocities [m/s], shape (N, 3); ``x`` is changed.
        previous, start: get the positions before [m], shape (N, 3).
        mobility: inverse masses, as shares of the mean's; 0 for held particles, shape (N,).
        dt: the substep [s].
        fastest: top speed [m/s].
    """
    fall = np.float32(9.81) * dt
    for i in range(x.shape[0]):
        for axis in range(3):
            previous[i, axis], start[i, axis] = x[i, axis], x[i, axis]
        if mobility[i] == np.float32(0.0):
            continue
        vx, vy, vz = v[i, 0], v[i, 1], v[i, 2] - fall
        speed_2 = vx * vx + vy * vy + vz * vz
        step = dt
        if speed_2 > fastest * fastest:
            step = dt * fastest / np.sqrt(speed_2)
        x[i, 0] += vx * step
        x[i, 1] += vy * step
        x[i, 2] += vz * step


@compiled
def carry(x, mobility, grasped, offsets, arm, directions, path, turns, k, most):
    """Put the grasped particles where the grippers are, turned about the crease's direction.

    What was held back catches up by at most ``most`` [m]; what has slipped out of its grip, and can move, is left.
    """
    c, s = turns[k, 0], turns[k, 1]
    for g in range(grasped.shape[0]):
        i, a = grasped[g], arm[g]
        if mobility[i] > np.float32(0.0):
            continue
        ux, uy = directions[a, 0], directions[a, 1]
        forward = offsets[g, 0] * ux + offsets[g, 1] * uy
        up = offsets[g, 2]
        turned, risen = c * forward + s * up, c * up - s * forward
        px = path[k, a, 0] + offsets[g, 0] + (turned - forward) * ux
        py = path[k, a, 1] + offsets[g, 1] + (turned - forward) * uy
        pz = path[k, a, 2] + risen
        dx, dy, dz = px - x[i, 0], py - x[i, 1], pz - x[i, 2]
        way_2 = dx * dx + dy * dy + dz * dz
        if way_2 > most * most:
            share = most / np.sqrt(way_2)
            px, py, pz = x[i, 0] + share * dx, x[i, 1] + share * dy, x[i, 2] + share * dz
        x[i, 0], x[i, 1], x[i, 2] = px, py, pz


@compiled
def velocities(x, previous, start, v, inverse_dt):
    """Velocities [m/s] of a substep into ``v``, shape (N, 3), from positions ``x`` at its end [m].

    Overlap that was opened silently moved ``previous`` away from the ``start``: neither that is a velocity, nor that
    something else closed it again. Along each axis it is the lesser of the ways from both, and none if they disagree.
    """
    zero = np.float32(0.0)
    for i in range(x.shape[0]):
        for axis in range(3):
            way, other = x[i, axis] - start[i, axis], x[i, axis] - previous[i, axis]
            least = max(zero, min(way, other)) if way > zero else min(zero, max(way, other))
            v[i, axis] = least * inverse_dt


@compiled
def rests(x, rested, limit):
    """Whether particles at ``x`` [m], shape (N, 3), are less than ``limit`` [m] RMS from ``rested``, which follows."""
    moved = np.float32(0.0)
    for i in range(x.shape[0]):
        for axis in range(3):
            way = x[i, axis] - rested[i, axis]
            moved += way * way
            rested[i, axis] = x[i, axis]
    return moved < x.shape[0] * limit * limit


@compiled
def is_finite(x):
    """Whether all positions [m], shape (N, 3), are numbers within 100 m."""
    for i in range(x.shape[0]):
        for axis in range(3):
            if not abs(x[i, axis]) < np.float32(100.0):
                return False
    return True
