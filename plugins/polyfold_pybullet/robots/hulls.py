"""Convex hulls with few corners in place of finely meshed ones, so that distances between links take little time.

PyBullet 3.2.7 measures a link by the hull of its mesh and asks every corner of it again and again; hulls of ABB's YuMi
have up to 4,400. With corners left out that stand out by less than a millimetre, they have at most 200.
"""

from __future__ import annotations

import struct
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FINE = 300
"""A hull with more corners is a fine one."""
TOLERANCE = 0.001
"""By how much the whole hull may stand out of what takes its place [m]."""

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_STL_HEAD = 84


def with_lean_hulls(urdf: Path, into: Path) -> Path:
    """A URDF whose finely meshed convex links are measured by leaner hulls.

    Args:
        urdf: the file. Shapes that it marks as concave, and meshes that are no binary STL or OBJ, stay as they are.
        into: folder to write to.

    Returns:
        Path of the file written; ``urdf`` itself if nothing in it is fine.
    """
    robot = ElementTree.parse(urdf).getroot()
    lean = {}
    for shape in robot.iter("collision"):
        for mesh in shape.iter("mesh") if shape.get("concave") != "yes" else ():
            path = urdf.parent / str(mesh.get("filename"))
            scale = max(abs(float(value)) for value in mesh.get("scale", "1").split())
            if path.is_file() and (corners := _lean_corners(path, TOLERANCE / scale)) is not None:
                lean[mesh] = _written(corners, into / f"{len(lean)}-{path.stem}-hull.obj")
    if not lean:
        return urdf
    for mesh in robot.iter("mesh"):
        # What is relative is so to the folder that the file leaves.
        there = lean.get(mesh, urdf.parent / str(mesh.get("filename")))
        if there.is_file():
            mesh.set("filename", str(there))
    written = into / f"{urdf.stem}-lean.urdf"
    ElementTree.ElementTree(robot).write(written)
    return written


def lean_hull(points: Floats, tolerance: float) -> Floats:
    """Some corners of the hull of points, shape (N, 3), out of whose hull no point stands by more than a tolerance.

    Farthest ones are added until none is too far out.

    Returns:
        shape (K, 3).
    """
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    kept = np.zeros(len(corners), bool)
    kept[np.concatenate([[0, 1, 2, 3], corners.argmin(0), corners.argmax(0)])] = True
    while True:
        # Joggled, since the first few corners may lie in one plane.
        facets = ConvexHull(corners[kept], qhull_options="QJ").equations
        out = corners @ facets[:, :3].T + facets[:, 3]
        far = out.max(1) > tolerance
        if not far.any():
            return corners[kept]
        over = out.argmax(1)
        for facet in np.unique(over[far]):
            those = np.flatnonzero(far & (over == facet))
            kept[those[out[those, facet].argmax()]] = True


@lru_cache(maxsize=64)
def _lean_corners(path: Path, tolerance: float) -> Floats | None:
    """The corners of a mesh's leaner hull, or None if that is not fine or can't be read."""
    from scipy.spatial import ConvexHull, QhullError

    points = _mesh_points(path)
    try:
        if points is None or len(points) <= FINE or len(ConvexHull(points).vertices) <= FINE:
            return None
        return lean_hull(points, tolerance)
    except QhullError:
        return None


def _mesh_points(path: Path) -> Floats | None:
    """The points of a mesh, shape (N, 3); None if it is no binary STL or OBJ."""
    content = path.read_bytes()
    if path.suffix.lower() == ".stl" and len(content) >= _STL_HEAD:
        (count,) = struct.unpack_from("<I", content, _STL_HEAD - 4)
        if len(content) == _STL_HEAD + count * _FACET.itemsize:
            facets = np.frombuffer(content, _FACET, offset=_STL_HEAD)
            return np.unique(facets["corners"].reshape(-1, 3), axis=0).astype(float)
    if path.suffix.lower() == ".obj":
        lines = (line.split() for line in content.decode(errors="replace").splitlines())
        points = [line[1:4] for line in lines if len(line) > 3 and line[0] == "v"]
        return np.array(points, float) if points else None
    return None


def _written(corners: Floats, path: Path) -> Path:
    """Write a hull as OBJ."""
    from scipy.spatial import ConvexHull

    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in ConvexHull(corners).simplices]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path
