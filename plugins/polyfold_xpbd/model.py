"""Everything about a garment's mesh that the solver needs and that never changes: constraints in a good order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Fabric, Mesh

GRAVITY = 9.81
SHARPEST = 0.5
"""A hinge that is bent by more than this share of what its mesh allows is a crease, however coarse the mesh."""
LIGHTEST = 3.0
"""No particle is lighter than the mean by more than this factor: slivers at a curved rim would be flung about."""


@dataclass(frozen=True, eq=False)
class ClothModel:
    """A mesh turned into constraints.

    Attributes:
        edges: vertex pairs, uint32, shape (E, 2), sorted by colour: no two edges of a colour share a vertex.
        rest_lengths: [m], float32, shape (E,).
        hinges: the two ends of an inner edge, then the two opposite corners, uint32, shape (H, 4).
        hinge_weights: curvature stencil times the square root of stiffness per mass [1/s], float32, shape (H, 4).
        elastic: length of the stencil [m/s] up to which a hinge bends elastically, float32, shape (H,).
        normal_corners: corners whose normal a triangle contributes to, uint32, shape (T, 3) (see ``normal_use``).
        normal_use: 1 where the corner takes its normal from that triangle, float32, shape (T, 3).
        panel: panel of each triangle, int32, shape (T,).
        edge_length, longest_edge: mean and greatest rest length [m].
        lightness: inverse masses, as shares of the mean's, float32, shape (N,).
        bending_rate: angular frequency of the fastest bending [1/s].
    """

    edges: NDArray[np.uint32]
    rest_lengths: NDArray[np.float32]
    hinges: NDArray[np.uint32]
    hinge_weights: NDArray[np.float32]
    elastic: NDArray[np.float32]
    normal_corners: NDArray[np.uint32]
    normal_use: NDArray[np.float32]
    panel: NDArray[np.int32]
    edge_length: float
    longest_edge: float
    lightness: NDArray[np.float32]
    bending_rate: float


def build_model(mesh: Mesh, fabric: Fabric) -> ClothModel:
    """Constraints of a mesh of this fabric."""
    triangles = np.asarray(mesh.triangles, np.int64)
    rest = np.asarray(mesh.vertices, float)[:, :2]
    edges = _unique_edges(triangles)
    lengths = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    order = _colour_order(edges, len(rest))
    edges, lengths = edges[order], lengths[order]
    hinges, weights, elastic = _hinges(mesh, triangles, rest, fabric)
    lightness = _lightness(triangles, rest)
    from_back = np.asarray(mesh.seam)[triangles] & (np.asarray(mesh.panel)[:, None] == 0)
    return ClothModel(
        edges.astype(np.uint32),
        lengths.astype(np.float32),
        hinges.astype(np.uint32),
        weights.astype(np.float32),
        elastic.astype(np.float32),
        triangles.astype(np.uint32),
        np.where(from_back, 0.0, 1.0).astype(np.float32),
        np.asarray(mesh.panel, np.int32),
        float(lengths.mean()),
        float(lengths.max()),
        lightness.astype(np.float32),
        _fastest(hinges, weights, lightness),
    )


def _lightness(triangles: NDArray[np.int64], rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse masses of the particles, as shares of the mean's, shape (N,): each has a third of its triangles.

    The rim's particles stand for half as much cloth as others; as heavy as they, they would make a hanging edge limp.
    """
    u, w = (rest[triangles[:, k]] - rest[triangles[:, 0]] for k in (1, 2))
    areas = np.abs(u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0])
    masses = np.bincount(triangles.ravel(), np.repeat(areas, 3), len(rest))
    return np.minimum(masses.mean() / np.maximum(masses, 1e-12), LIGHTEST)


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
    mesh: Mesh, triangles: NDArray[np.int64], rest: NDArray[np.float64], fabric: Fabric
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
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
    around = area(x0, x1, x2) + area(x0, x1, x3)
    bent = (stencil[:, :, None] * rest[hinges] ** 2 / 2).sum(axis=1)
    rigidity = _rigidity(x1 - x0, bent**2 / around[:, None], sheet, fabric)
    root = np.sqrt(1.0 / around * rigidity / area_per_particle)
    # Bent to a curvature, a stencil is as long as the curvature times the area of its two triangles.
    sharpest = 2.0 * np.hypot(*(x1 - x0).T) / around
    elastic = np.minimum(fabric.crease_yield, SHARPEST * sharpest) * around * root
    return hinges, stencil * root[:, None], elastic


def _fastest(hinges: NDArray[np.int64], weights: NDArray[np.float64], lightness: NDArray[np.float64]) -> float:
    """Angular frequency [1/s] of the stiffest mode of all hinges together, by power iteration."""
    count = len(lightness)
    from scipy.sparse import csr_array

    if len(hinges) == 0:
        return 0.0
    weights = weights * np.sqrt(lightness)[hinges]
    stencils = csr_array((weights.ravel(), hinges.ravel(), 4 * np.arange(len(hinges) + 1)), shape=(len(hinges), count))
    shape = np.random.default_rng(0).standard_normal(count)
    for _ in range(40):
        shape = stencils.T @ (stencils @ shape)
        shape /= max(np.linalg.norm(shape), 1e-30)
    return float(np.linalg.norm(stencils @ shape))


def _rigidity(
    along: NDArray[np.float64], shares: NDArray[np.float64], sheet: float, fabric: Fabric
) -> NDArray[np.float64]:
    """Bending rigidity per weight times gravity [m⁴/s²] of hinges, shape (H,): about g times c³.

    Hinges of three directions share every bend, and at the sheet's rim some are missing. How much of the rigidity a
    direction gets is therefore such that this very sheet, rolled up along weft or warp, stores ½ B κ² in its area.

    Args:
        along: from one end of each hinge to the other [m], shape (H, 2).
        shares: what each stores per rigidity if the sheet has curvature 1 along x, and along y, shape (H, 2).
        sheet: area [m²].
        fabric: warp runs along y, weft along x.
    """
    weft, warp = GRAVITY * fabric.bending_length_weft**3, GRAVITY * fabric.bending_length_warp**3
    lean = (along[:, 0] ** 2 - along[:, 1] ** 2) / (along**2).sum(axis=1)
    directions = np.stack([np.ones(len(lean)), lean])
    parts = np.linalg.lstsq((directions @ shares).T, sheet * np.array([weft, warp]), rcond=1e-3)[0]
    return np.maximum(parts @ directions, 0.1 * min(warp, weft))
