"""RGBench's garments, flat closed meshes in OBJ files, as meshes of ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError
from polyfold.garments import Mesh

FLAT = 0.15
"""A garment that is higher than this share of its length does not lie flat."""


def read_garment(path: str | Path, pose: NDArray[np.float64]) -> Mesh:
    """The mesh of a file with its triangles as they are, lying where the pose puts it.

    Triangles that face up are the upper panel, those that face down the lower one; vertices of both are the seam.

    Args:
        path: an OBJ file [m], z up.
        pose: position [m] and quaternion (w, x, y, z), shape (7,).

    Raises:
        GarmentError: if it can't be read or does not lie flat.
    """
    import trimesh
    from scipy.spatial.transform import Rotation

    try:
        loaded: Any = trimesh.load(Path(path), force="mesh", process=False, maintain_order=True)
        points, triangles = np.asarray(loaded.vertices, float), np.asarray(loaded.faces, np.int32)
    except Exception as error:  # trimesh raises whatever its parsers stumble over
        raise GarmentError(f"the mesh {path} can't be read ({error}); give one of RGBench's OBJ files") from error
    points = Rotation.from_quat(pose[[4, 5, 6, 3]]).apply(points) + pose[:3]
    size = np.ptp(points, axis=0)
    if size[2] > FLAT * size[:2].max():
        raise GarmentError(f"{path} is {size[2]:.2f} m high in its pose; give a flat garment and z up")
    return _two_panels(points[:, :2], triangles)


def _two_panels(flat: NDArray[np.float64], triangles: NDArray[np.int32]) -> Mesh:
    a, b, c = flat[triangles].transpose(1, 0, 2)
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    up = doubled > 0
    in_upper, in_lower = np.zeros(len(flat), bool), np.zeros(len(flat), bool)
    in_upper[triangles[up]] = True
    in_lower[triangles[~up]] = True
    if not in_lower.any():
        panel, seam = np.zeros(len(triangles), np.int8), np.zeros(len(flat), bool)
        layer = np.zeros(len(flat), np.int8)
    else:
        panel, seam = up.astype(np.int8), in_upper & in_lower
        layer = (in_upper & ~in_lower).astype(np.int8)
    facing_up = triangles.copy()
    facing_up[~up, 1], facing_up[~up, 2] = triangles[~up, 2], triangles[~up, 1]
    return Mesh(flat, facing_up, panel, layer, seam, np.flatnonzero(seam).astype(np.int32))


def lying(mesh: Mesh, thickness: float) -> NDArray[np.float64]:
    """Positions of a garment on the table [m], shape (N, 3), its plies ``thickness`` [m] apart."""
    height = thickness * (0.5 + mesh.layer.astype(float))
    height[mesh.seam] = thickness
    return np.column_stack([mesh.vertices, height])
