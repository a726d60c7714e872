"""What went well or wrong with a simulated cloth: strain, layer order, layers that pierce each other."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh

Floats = NDArray[np.float64]


@lru_cache(maxsize=4)
def edges_of(mesh: Mesh) -> NDArray[np.int64]:
    """Unique vertex pairs, shape (E, 2)."""
    t = np.asarray(mesh.triangles, np.int64)
    return np.unique(np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1), axis=0)


def strain(mesh: Mesh, positions: Floats) -> Floats:
    """Signed relative change of every edge's length, shape (E,), for positions [m], shape (N, 3)."""
    a, b = edges_of(mesh).T
    rest = np.linalg.norm(mesh.vertices[a] - mesh.vertices[b], axis=1)
    return np.linalg.norm(positions[a] - positions[b], axis=1) / rest - 1.0


def layer_order(positions: Floats, lifted: NDArray[np.bool_], far: NDArray[np.bool_], radius: float) -> float:
    """Share of lifted particles that lie above every unlifted one within ``radius`` [m]; NaN if none has one below.

    Args:
        positions: where the particles are [m], shape (N, 3).
        lifted: which the fold was to lift, shape (N,).
        far: which of them count (away from the crease), shape (N,).
        radius: how near a neighbour is, seen from above [m].
    """
    from scipy.spatial import KDTree

    counted, lower = np.flatnonzero(lifted & far), np.flatnonzero(~lifted)
    if len(counted) == 0 or len(lower) == 0:
        return float("nan")
    neighbours = KDTree(positions[lower, :2]).query_ball_point(positions[counted, :2], radius)
    right = [positions[i, 2] > positions[lower[n], 2].max() for i, n in zip(counted, neighbours, strict=True) if n]
    return float(np.mean(right)) if right else float("nan")


def crossing_edges(mesh: Mesh, positions: Floats) -> float:
    """Share of the mesh's edges that pierce a triangle they share no vertex with, at positions [m], shape (N, 3)."""
    from scipy.spatial import KDTree

    edges, triangles = edges_of(mesh), np.asarray(mesh.triangles, np.int64)
    p, q = positions[edges[:, 0]], positions[edges[:, 1]]
    corners = positions[triangles]
    centres = corners.mean(axis=1)
    spread = float(np.linalg.norm(corners - centres[:, None], axis=2).max())
    reach = spread + float(np.linalg.norm(q - p, axis=1).max()) / 2
    near = KDTree((p + q) / 2).query_ball_tree(KDTree(centres), reach)
    e = np.repeat(np.arange(len(edges)), [len(n) for n in near])
    t = np.concatenate([np.asarray(n, np.int64) for n in near])
    apart = (edges[e][:, :, None] != triangles[t][:, None, :]).all(axis=(1, 2))
    e, t = e[apart], t[apart]
    return len(np.unique(e[_pierces(p[e], q[e], corners[t])])) / len(edges)


def _pierces(p: Floats, q: Floats, corners: Floats) -> NDArray[np.bool_]:
    """Whether the segments p-q go through the triangles (Moeller and Trumbore), shape (K,)."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    d = q - p
    h = np.cross(d, v)
    det = (u * h).sum(1)
    flat = np.abs(det) < 1e-14
    inverse = 1.0 / np.where(flat, 1.0, det)
    s = p - a
    beta = (s * h).sum(1) * inverse
    w = np.cross(s, u)
    gamma = (d * w).sum(1) * inverse
    along = (v * w).sum(1) * inverse
    return ~flat & (beta >= 0) & (gamma >= 0) & (beta + gamma <= 1) & (along >= 0) & (along <= 1)
