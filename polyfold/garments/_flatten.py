"""Lay a worn garment flat: its front and back, each nearly unstretched, joined along the silhouette."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
Complex = NDArray[np.complex128]

ROUNDS = 300
SETTLED = 1e-4  # largest step, relative to the garment's size, at which flattening stops


@dataclass(frozen=True, eq=False)
class Flattened:
    """A surface pressed onto the plane.

    Attributes:
        points: vertex positions [unit of the input], shape (N, 2).
        distortion: relative change of each edge's length, shape (E,).
        flipped: share of the area whose faces turned over.
    """

    points: Floats
    distortion: Floats
    flipped: float


def front_faces(vertices: Floats, faces: Faces, viewer: Floats) -> NDArray[np.bool_]:
    """Which faces belong to the front as seen from a direction, shape (F,).

    The faces' normals are averaged over their neighbourhood, so that wrinkles don't tear the panels; islands of one
    panel inside the other are given to the panel around them.

    Args:
        vertices: positions, shape (N, 3).
        faces: consistently wound vertex indices, shape (F, 3).
        viewer: unit vector towards the viewer, shape (3,).
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    a, b, c = vertices[faces].transpose(1, 0, 2)
    facing = np.cross(b - a, c - a) @ viewer
    neighbours = _face_neighbours(faces)
    size = len(faces)
    adjacency = coo_matrix((np.ones(len(neighbours)), neighbours.T), (size, size)).tocsr()
    adjacency = adjacency + adjacency.T
    degree = np.maximum(np.asarray(adjacency.sum(1)).ravel(), 1.0)
    for _ in range(6):
        facing = 0.5 * facing + 0.5 * (adjacency @ facing) / degree
    front = facing > 0
    for _ in range(2):
        alike = front[neighbours[:, 0]] == front[neighbours[:, 1]]
        same = neighbours[alike]
        _, label = connected_components(coo_matrix((np.ones(len(same)), same.T), (size, size)), directed=False)
        for side in (True, False):
            labels, counts = np.unique(label[front == side], return_counts=True)
            if len(labels):
                front[(front == side) & (label != labels[np.argmax(counts)])] = not side
    return front


def flatten(vertices: Floats, faces: Faces, front: NDArray[np.bool_], right: Floats, up: Floats) -> Flattened:
    """Press a surface flat as rigidly as possible (as-rigid-as-possible, local and global steps in turn).

    Every face keeps its shape as well as it can; faces of the back come to lie the other way round under the front.

    Args:
        vertices: positions, shape (N, 3).
        faces: consistently wound vertex indices, shape (F, 3).
        front: which faces belong to the front, shape (F,).
        right, up: unit vectors of the plane, shape (3,).
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import splu

    rest = _rest_shapes(vertices, faces, front, right, up)
    weights = _cotangents(rest)
    start, end = faces, np.roll(faces, -1, axis=1)
    rest_edges = np.roll(rest, -1, axis=1) - rest
    count = len(vertices)
    i, j, w = start.ravel(), end.ravel(), weights.ravel()
    rows, columns = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
    laplacian = coo_matrix((np.concatenate([w, w, -w, -w]), (rows, columns)), (count, count)).tocsc()
    anchor = coo_matrix(([1e-9 * w.sum()], ([0], [0])), (count, count)).tocsc()
    solver = splu(laplacian + anchor)
    points = vertices @ right + 1j * (vertices @ up)
    points -= points[0]
    scale = float(np.abs(points).max())
    for _ in range(ROUNDS):
        edges = points[end] - points[start]
        turn = (weights * np.conj(rest_edges) * edges).sum(1)
        turn /= np.maximum(np.abs(turn), 1e-30)
        pull = (weights * rest_edges * turn[:, None]).ravel()
        target = np.zeros(count, np.complex128)
        np.add.at(target, i, -pull)
        np.add.at(target, j, pull)
        solution: Floats = np.asarray(solver.solve(np.column_stack([target.real, target.imag])), float)
        moved = solution[:, 0] + 1j * solution[:, 1]
        moved -= moved[0]
        step = float(np.abs(moved - points).max())
        points = moved
        if step < SETTLED * scale:
            break
    return _measured(points, faces, rest, rest_edges)


def _face_neighbours(faces: Faces) -> Faces:
    """Pairs of faces that share an edge, shape (P, 2)."""
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    shared = (edges[1:] == edges[:-1]).all(1)
    return np.column_stack([owner[:-1][shared], owner[1:][shared]])


def _rest_shapes(vertices: Floats, faces: Faces, front: NDArray[np.bool_], right: Floats, up: Floats) -> Complex:
    """Each face's shape in the plane, as complex numbers, shape (F, 3); mirrored on the back."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    along = b - a
    length = np.linalg.norm(along, axis=1)
    unit = along / length[:, None]
    x = ((c - a) * unit).sum(1)
    y = np.linalg.norm(c - a - x[:, None] * unit, axis=1)
    # Seen from the viewer, a face of the front keeps the sense in which it is wound and one of the back reverses it.
    front_wound = np.cross(b - a, c - a) @ np.cross(right, up)
    sense = np.sign(front_wound[front].sum()) or 1.0
    y = np.where(front, sense * y, -sense * y)
    return np.column_stack([np.zeros(len(faces), complex), length, x + 1j * y])


def _cotangents(rest: Complex) -> Floats:
    """Half the cotangent opposite each edge (0-1, 1-2, 2-0), kept positive, shape (F, 3)."""
    opposite = np.roll(rest, 1, axis=1)
    p, q = rest - opposite, np.roll(rest, -1, axis=1) - opposite
    product = np.conj(p) * q
    return np.clip(0.5 * product.real / np.maximum(np.abs(product.imag), 1e-12), 0.02, 10.0)


def _measured(points: Complex, faces: Faces, rest: Complex, rest_edges: Complex) -> Flattened:
    lengths = np.abs(np.roll(points[faces], -1, axis=1) - points[faces])
    distortion = lengths / np.abs(rest_edges) - 1.0
    edges = np.sort(np.column_stack([faces.ravel(), np.roll(faces, -1, axis=1).ravel()]), axis=1)
    _, once = np.unique(edges, axis=0, return_index=True)
    placed = points[faces]
    area = _signed_areas(placed)
    wanted = _signed_areas(rest)
    flipped = float(np.abs(wanted[area * wanted < 0]).sum() / np.abs(wanted).sum())
    return Flattened(np.column_stack([points.real, points.imag]), distortion.ravel()[once], flipped)


def _signed_areas(corners: Complex) -> Floats:
    return 0.5 * (np.conj(corners[:, 1] - corners[:, 0]) * (corners[:, 2] - corners[:, 0])).imag
