"""How kernels are compiled, and what they share: adding to a vector, and the normals of the sheet."""

from __future__ import annotations

import numpy as np
from numba import njit

from polyfold_xpbd.compiling import kept

compiled = njit(error_model="numpy")
"""Without fast maths: reordered sums end differently on another processor, and in machine code read back from a cache.

A last bit is enough to move a fold by centimetres. numba 0.68 runs a helper's own machine code in the process that
compiled it, and the caller's copy of it in those that load the caller from the cache.
"""


@compiled
def shift(vectors, i, scale, x, y, z):
    """Add ``scale`` times (x, y, z) to vector i of ``vectors``, shape (N, 3)."""
    vectors[i, 0] += scale * x
    vectors[i, 1] += scale * y
    vectors[i, 2] += scale * z


@compiled
def copy_rows(source, target):
    """Copy rows, shape (N, 3), one by one.

    For ``target[:, :] = source`` numba 0.68 would also compile a message in case shapes differ, two seconds of work.
    """
    for i in range(source.shape[0]):
        for axis in range(3):
            target[i, axis] = source[i, axis]


@kept
def vertex_normals(x, corners, use, normals):
    """Area-weighted mean normals of the particles into ``normals``, shape (N, 3).

    Their length says how flat the sheet is there: 1 where all triangles agree, near 0 on a sharp crease.
    """
    areas = np.full(x.shape[0], np.float32(1e-20), np.float32)
    normals[:, :] = np.float32(0.0)
    for t in range(corners.shape[0]):
        a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
        ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        vx, vy, vz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area = np.sqrt(nx * nx + ny * ny + nz * nz)
        for k in range(3):
            vertex, weight = corners[t, k], use[t, k]
            shift(normals, vertex, weight, nx, ny, nz)
            areas[vertex] += weight * area
    for i in range(x.shape[0]):
        inverse = np.float32(1.0) / areas[i]
        normals[i, 0] *= inverse
        normals[i, 1] *= inverse
        normals[i, 2] *= inverse
