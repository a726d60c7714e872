"""A chain of joints: where its tool is, its Jacobian, and joint angles for a wanted pose of the tool."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit


def kept(function: Callable[..., Any]) -> Any:
    """Compile a function and keep its machine code; where it can't be kept, compile it in each process."""
    try:
        return njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba finds no folder that can be written to
        return njit(error_model="numpy")(function)


@kept
def _multiply(a, b, out):
    """The product of two poses, shape (4, 4) each, into a third."""
    for i in range(3):
        for j in range(4):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
        out[i, 3] += a[i, 3]


@kept
def _move(at, axis, slides, value, out):
    """The pose of what a joint moves: ``at`` turned about its axis, or slid along it, into ``out``."""
    out[:, :] = at
    if slides:
        for i in range(3):
            out[i, 3] += value * (at[i, 0] * axis[0] + at[i, 1] * axis[1] + at[i, 2] * axis[2])
        return
    c, s = np.cos(value), np.sin(value)
    x, y, z = axis[0], axis[1], axis[2]
    turn = np.empty((3, 3))
    turn[0, 0], turn[0, 1], turn[0, 2] = c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s
    turn[1, 0], turn[1, 1], turn[1, 2] = y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s
    turn[2, 0], turn[2, 1], turn[2, 2] = z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)
    for i in range(3):
        for j in range(3):
            out[i, j] = at[i, 0] * turn[0, j] + at[i, 1] * turn[1, j] + at[i, 2] * turn[2, j]


@kept
def forward(origins, axes, prismatic, tool, q, found, jacobian):
    """Pose of the tool into ``found``, shape (4, 4), and its geometric Jacobian into ``jacobian``, shape (6, N).

    The Jacobian's first three rows are the tool's velocity, the others its angular velocity, both in the world.
    """
    n = q.shape[0]
    at, moved = np.eye(4), np.eye(4)
    places, ways = np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        _multiply(moved, origins[k], at)
        for i in range(3):
            places[k, i] = at[i, 3]
            ways[k, i] = at[i, 0] * axes[k, 0] + at[i, 1] * axes[k, 1] + at[i, 2] * axes[k, 2]
        _move(at, axes[k], prismatic[k], q[k], moved)
    found[3, :] = 0.0
    found[3, 3] = 1.0
    _multiply(moved, tool, found)
    for k in range(n):
        wx, wy, wz = ways[k, 0], ways[k, 1], ways[k, 2]
        if prismatic[k]:
            jacobian[0, k], jacobian[1, k], jacobian[2, k] = wx, wy, wz
            jacobian[3, k] = jacobian[4, k] = jacobian[5, k] = 0.0
            continue
        rx, ry, rz = found[0, 3] - places[k, 0], found[1, 3] - places[k, 1], found[2, 3] - places[k, 2]
        jacobian[0, k], jacobian[1, k], jacobian[2, k] = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
        jacobian[3, k], jacobian[4, k], jacobian[5, k] = wx, wy, wz


@kept
def twist_between(here, there, out):
    """The way from one pose to another: translation [m] and rotation vector [rad], in the world, shape (6,)."""
    turn = np.empty((3, 3))
    for i in range(3):
        out[i] = there[i, 3] - here[i, 3]
        for j in range(3):
            turn[i, j] = there[i, 0] * here[j, 0] + there[i, 1] * here[j, 1] + there[i, 2] * here[j, 2]
    x, y, z = turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]
    sine = 0.5 * np.sqrt(x * x + y * y + z * z)
    cosine = 0.5 * (turn[0, 0] + turn[1, 1] + turn[2, 2] - 1.0)
    angle = np.arctan2(sine, cosine)
    if sine > 1e-7:
        scale = 0.5 * angle / sine
        out[3], out[4], out[5] = scale * x, scale * y, scale * z
    elif cosine > 0.0:
        out[3], out[4], out[5] = 0.5 * x, 0.5 * y, 0.5 * z
    else:
        # Half a turn: the axis is in the symmetric part, of which the column with the largest diagonal is surest.
        k = 0
        for i in range(1, 3):
            if turn[i, i] > turn[k, k]:
                k = i
        length = np.sqrt(max(1e-12, 0.5 * (turn[k, k] + 1.0)))
        for i in range(3):
            out[3 + i] = angle * (0.5 * (turn[i, k] + (1.0 if i == k else 0.0))) / length


@kept
def _solve_in_place(matrix, vectors):
    """Solve for a symmetric positive definite matrix, shape (6, 6), by Cholesky, for each column of ``vectors``."""
    for i in range(6):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = np.sqrt(max(total, 1e-15)) if i == j else total / matrix[j, j]
    for c in range(vectors.shape[1]):
        for i in range(6):
            for k in range(i):
                vectors[i, c] -= matrix[i, k] * vectors[k, c]
            vectors[i, c] /= matrix[i, i]
        for i in range(5, -1, -1):
            for k in range(i + 1, 6):
                vectors[i, c] -= matrix[k, i] * vectors[k, c]
            vectors[i, c] /= matrix[i, i]


@kept
def _step(jacobian, error, wish, damping, free, dq):
    """One damped step of the free joints towards the pose, and as far as that allows towards ``wish``; into ``dq``."""
    n = dq.shape[0]
    matrix, sides = np.zeros((6, 6)), np.empty((6, 2))
    for i in range(6):
        sides[i, 0], sides[i, 1] = error[i], 0.0
        for k in range(n):
            if free[k]:
                sides[i, 1] += jacobian[i, k] * wish[k]
        for j in range(6):
            for k in range(n):
                if free[k]:
                    matrix[i, j] += jacobian[i, k] * jacobian[j, k]
        matrix[i, i] += damping
    _solve_in_place(matrix, sides)
    for k in range(n):
        dq[k] = 0.0
        if free[k]:
            dq[k] = wish[k]
            for i in range(6):
                dq[k] += jacobian[i, k] * (sides[i, 0] - sides[i, 1])


@kept
def descend(chain, target, home, start, tolerances, iterations, settling, best):
    """Damped least squares from one start, with ``home`` as the target of the null space.

    The damping follows the error (Sugihara, IEEE T-RO 2011, 10.1109/TRO.2011.2148230). A joint at its limit is held
    there while the step would push it out. Once the pose is reached, up to ``settling`` more steps go towards home.

    Args:
        chain: origins, axes, prismatic, tool, lower and upper, as in ``Chain``.
        target: wanted pose of the tool, shape (4, 4).
        home, start: joint angles, shape (N,).
        tolerances: of position [m] and orientation [rad].
        iterations: most steps.
        best: the joint angles found, shape (N,).

    Returns:
        Whether the pose was reached.
    """
    origins, axes, prismatic, tool, lower, upper = chain
    n = start.shape[0]
    q = np.minimum(np.maximum(start, lower), upper)
    found, jacobian, error = np.empty((4, 4)), np.empty((6, n)), np.empty(6)
    wish, dq, free = np.empty(n), np.empty(n), np.empty(n, np.bool_)
    reached, least, after = False, np.inf, 0
    nearest, stalled = np.inf, 0
    for _ in range(iterations):
        forward(origins, axes, prismatic, tool, q, found, jacobian)
        twist_between(found, target, error)
        off = np.sqrt(error[0] ** 2 + error[1] ** 2 + error[2] ** 2)
        turned = np.sqrt(error[3] ** 2 + error[4] ** 2 + error[5] ** 2)
        if off <= tolerances[0] and turned <= tolerances[1]:
            distance = 0.0
            for k in range(n):
                distance += (q[k] - home[k]) ** 2
            if not reached or distance < least:
                # Less than this is not worth another step.
                if reached and distance > 0.995 * least:
                    after = settling
                best[:] = q
                least = distance
            reached = True
        if reached:
            after += 1
            if after > settling:
                break
        elif off + turned < 0.8 * nearest:
            nearest, stalled = off + turned, 0
        else:
            stalled += 1
            if stalled > 5:
                break
        damping = 0.05 * (off * off + turned * turned) + 1e-6
        for k in range(n):
            wish[k] = 0.2 * (home[k] - q[k]) if reached else 0.0
            free[k] = True
        for _again in range(n):
            _step(jacobian, error, wish, damping, free, dq)
            held = False
            for k in range(n):
                out = (q[k] <= lower[k] and dq[k] < 0.0) or (q[k] >= upper[k] and dq[k] > 0.0)
                if free[k] and out:
                    free[k], held = False, True
            if not held:
                break
        longest = 0.0
        for k in range(n):
            longest = max(longest, abs(dq[k]))
        scale = min(1.0, 0.5 / longest) if longest > 0.0 else 1.0
        for k in range(n):
            q[k] = min(max(q[k] + scale * dq[k], lower[k]), upper[k])
    return reached


@kept
def solve(chain, target, home, starts, tolerances, iterations, settling, wanted, answers):
    """From one start after another until ``wanted`` are reached; the answers into ``answers``, shape (wanted, N).

    Returns:
        How many were found; those that are alike count once.
    """
    found = 0
    answer = np.empty(starts.shape[1])
    for r in range(starts.shape[0]):
        if not descend(chain, target, home, starts[r], tolerances, iterations, settling, answer):
            continue
        new = True
        for other in range(found):
            if np.max(np.abs(answers[other] - answer)) < 0.1:
                new = False
        if new:
            answers[found] = answer
            found += 1
            if found == wanted:
                break
    return found


@kept
def tools_along(chain, path, out):
    """Poses of the tool at the rows of a path, shape (T, N), into ``out``, shape (T, 4, 4)."""
    origins, axes, prismatic, tool, _lower, _upper = chain
    jacobian = np.empty((6, path.shape[1]))
    for t in range(path.shape[0]):
        forward(origins, axes, prismatic, tool, path[t], out[t], jacobian)
