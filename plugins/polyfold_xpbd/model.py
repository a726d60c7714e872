"""Everything about a garment's mesh that the solver needs and that never changes: constraints in a good order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh

GRAVITY = 9.81


@dataclass(frozen=True, eq=False)
class ClothModel:
    """A mesh turned into constraints.

    Attributes:
        edges: vertex pairs, uint32, shape (E, 2), sorted by colour: no two edges of a colour share a vertex.
        rest_lengths: [m], float32, shape (E,).
        hinges: the two ends of an inner edge, then the two opposite corners, uint32, shape (H, 4).
        hinge_weights: curvature stencil times the square root of stiffness per mass [1/s], float32, shape (H, 4).
        normal_corners: corners whose normal a triangle contributes to, uint32, shape (T, 3) (see ``normal_use``).
        normal_use: 1 where the corner takes its normal from that triangle, float32, shape (T, 3).
        excluded_start, excluded: vertices never in contact with vertex i: ``excluded[start[i]:start[i + 1]]``.
        edge_length: mean rest length [m].
    """

    edges: NDArray[np.uint32]
    rest_lengths: NDArray[np.float32]
    hinges: NDArray[np.uint32]
    hinge_weights: NDArray[np.float32]
    normal_corners: NDArray[np.uint32]
    normal_use: NDArray[np.float32]
    excluded_start: NDArray[np.uint32]
    excluded: NDArray[np.uint32]
    edge_length: float


def build_model(mesh: Mesh, bending_length: float) -> ClothModel:
    """Constraints of a mesh; ``bending_length`` is Peirce's [m]: stiffness per weight is its third power."""
    triangles = np.asarray(mesh.triangles, np.int64)
    rest = np.asarray(mesh.vertices, float)[:, :2]
    edges = _unique_edges(triangles)
    lengths = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    order = _colour_order(edges, len(rest))
    edges, lengths = edges[order], lengths[order]
    hinges, weights = _hinges(mesh, triangles, rest, bending_length)
    start, excluded = _exclusions(mesh, edges, rest, float(lengths.mean()))
    from_back = np.asarray(mesh.seam)[triangles] & (np.asarray(mesh.panel)[:, None] == 0)
    return ClothModel(
        edges.astype(np.uint32),
        lengths.astype(np.float32),
        hinges.astype(np.uint32),
        weights.astype(np.float32),
        triangles.astype(np.uint32),
        np.where(from_back, 0.0, 1.0).astype(np.float32),
        start.astype(np.uint32),
        excluded.astype(np.uint32),
        float(lengths.mean()),
    )


def _unique_edges(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _colour_order(edges: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Greedy edge colouring. A sweep along the mesh would push errors ahead of it; colours spread them."""
    used = np.zeros(count, np.int64)
    colours = np.empty(len(edges), np.int64)
    for index, (a, b) in enumerate(edges.tolist()):
        taken = int(used[a] | used[b])
        colour = (~taken & (taken + 1)).bit_length() - 1
        colours[index] = colour
        used[a] |= 1 << colour
        used[b] |= 1 << colour
    return np.argsort(colours, kind="stable")


def _hinges(
    mesh: Mesh, triangles: NDArray[np.int64], rest: NDArray[np.float64], bending_length: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Isometric bending (Bergou et al. 2006) over every inner edge of a panel; seams bend freely."""
    corners: dict[tuple[int, int, int], list[int]] = {}
    for (a, b, c), panel in zip(triangles.tolist(), np.asarray(mesh.panel).tolist(), strict=True):
        for i, j, k in ((a, b, c), (b, c, a), (c, a, b)):
            corners.setdefault((min(i, j), max(i, j), panel), []).append(k)
    hinges = np.array([(i, j, *k) for (i, j, _), k in corners.items() if len(k) == 2], np.int64).reshape(-1, 4)
    x0, x1, x2, x3 = (rest[hinges[:, k]] for k in range(4))

    def cotangent(at: NDArray[np.float64], p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
        u, v = p - at, q - at
        return (u * v).sum(1) / np.maximum(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), 1e-12)

    def area(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]) -> NDArray[np.float64]:
        u, v = q - p, r - p
        return 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    c01, c02 = cotangent(x0, x1, x2), cotangent(x0, x1, x3)
    c03, c04 = cotangent(x1, x0, x2), cotangent(x1, x0, x3)
    stencil = np.stack([c03 + c04, c01 + c02, -c01 - c03, -c02 - c04], axis=1)
    sheet = area(rest[triangles[:, 0]], rest[triangles[:, 1]], rest[triangles[:, 2]]).sum()
    area_per_particle = sheet / len(rest)
    stiffness = 3.0 / (area(x0, x1, x2) + area(x0, x1, x3)) * GRAVITY * bending_length**3 / area_per_particle
    return hinges, stencil * np.sqrt(stiffness)[:, None]


def _exclusions(
    mesh: Mesh, edges: NDArray[np.int64], rest: NDArray[np.float64], edge_length: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Neighbours along edges, and neighbours in the sheet that the mesh puts closer than a contact disc."""
    from scipy.spatial import KDTree

    close = KDTree(rest).query_pairs(0.95 * edge_length, output_type="ndarray").astype(np.int64)
    layer, seam = np.asarray(mesh.layer), np.asarray(mesh.seam)
    same_sheet = (layer[close[:, 0]] == layer[close[:, 1]]) | seam[close[:, 0]] | seam[close[:, 1]]
    pairs = np.concatenate([edges, close[same_sheet]])
    both = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    start = np.searchsorted(both[:, 0], np.arange(len(rest) + 1))
    return start, both[:, 1]
