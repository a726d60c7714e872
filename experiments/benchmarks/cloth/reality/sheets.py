"""Samples: strips, discs and piles of squares, meshed like garments are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh, Outline, mesh_panels

Floats = NDArray[np.float64]

ROW = float(np.sqrt(3) / 2)
"""Distance of two rows of the meshes' lattice in edge lengths."""


def strip(length: float, width: float, edge_length: float, lines: tuple[float, ...] = ()) -> Mesh:
    """A strip along x from -length/2 to length/2 [m].

    Args:
        length, width: [m].
        edge_length: of the mesh [m].
        lines: places along x [m] that get vertices on both long sides, so that a clamp there has a straight edge.
    """
    x = np.concatenate([[-length / 2], np.sort(lines), [length / 2]])
    below = np.column_stack([x, np.full(len(x), -width / 2)])
    above = np.column_stack([x[::-1], np.full(len(x), width / 2)])
    points = np.vstack([below, above])
    return mesh_panels(Outline(points, {str(k): k for k in range(len(points))}), 1, edge_length)[0]


def turned(mesh: Mesh) -> Mesh:
    """The same sample a quarter turned: what was along x is along y."""
    quarter = np.column_stack([-mesh.vertices[:, 1], mesh.vertices[:, 0]])
    return Mesh(quarter, mesh.triangles, mesh.panel, mesh.layer, mesh.seam, mesh.boundary)


def disc(radius: float, edge_length: float) -> Mesh:
    """A disc about the origin, radius [m]."""
    angle = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
    return mesh_panels(Outline(radius * np.column_stack([np.cos(angle), np.sin(angle)]), {}), 1, edge_length)[0]


def square(side: float, edge_length: float) -> Mesh:
    """A square about the origin, side [m]."""
    return strip(side, side, edge_length)


def pile(sheet: Mesh, plies: int) -> Mesh:
    """Separate copies of a one-layer sheet as one mesh; at rest they lie apart, side by side."""
    count, apart = len(sheet.vertices), 2 * float(np.ptp(sheet.vertices[:, 0]))
    ply = np.arange(plies)
    vertices = np.vstack([sheet.vertices + np.array([k * apart, 0.0]) for k in ply])
    return Mesh(
        vertices,
        np.vstack([sheet.triangles + k * count for k in ply]).astype(np.int32),
        np.tile(sheet.panel, plies),
        np.tile(sheet.layer, plies),
        np.tile(sheet.seam, plies),
        np.concatenate([sheet.boundary + k * count for k in ply]).astype(np.int32),
    )


def lifted(flat: Floats, height: float) -> Floats:
    """Flat points [m], shape (N, 2), at a height [m]: shape (N, 3)."""
    return np.column_stack([flat, np.full(len(flat), height)])
