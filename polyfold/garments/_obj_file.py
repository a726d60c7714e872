"""OBJ files as people have them: polygons of any shape, tabs, comments, byte-order marks, seams that nearly meet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError
from polyfold.errors._hints import file_problem

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ObjFile:
    """A surface in an OBJ file.

    Attributes:
        vertices: in the order of the file's ``v`` lines, then what polygons were cut at, shape (V, 3).
        faces: triangles, polygons cut into them, shape (F, 3).
        listed: how many vertices the file lists.
    """

    vertices: Floats
    faces: Faces
    listed: int


def read_obj(path: Path) -> ObjFile:
    """Read the vertices and faces of an OBJ file; all else in it is left out.

    Raises:
        GarmentError: naming the line that is wrong.
    """
    try:
        text = path.read_text("utf-8-sig", errors="replace")
    except OSError as error:
        raise GarmentError(file_problem(error, path)) from error
    rows, polygons = list[list[float]](), list[tuple[str, list[int]]]()
    for where, (word, *values) in _statements(text, path):
        if word == "v":
            rows.append(_vertex(values, where))
        elif word == "f":
            polygons.append((where, _polygon(values, len(rows), where)))
    vertices = np.array(rows, float).reshape(-1, 3)
    if not len(vertices) or not np.isfinite(vertices).all():
        raise GarmentError(f"{path} holds no finite vertices; give a triangle mesh in OBJ format")
    if not polygons:
        raise GarmentError(f"{path} has no faces; export it as a surface, not as points")
    cut = _Cut(vertices)
    for where, corners in polygons:
        cut.add(corners, where)
    return ObjFile(np.vstack([vertices, *cut.middles]), np.array(cut.faces, np.int64), len(vertices))


def _statements(text: str, path: Path) -> Iterator[tuple[str, list[str]]]:
    """Where each line stands, and its words; a backslash at the end joins two lines."""
    for number, line in enumerate(text.replace("\\\n", " ").splitlines(), 1):
        if words := line.partition("#")[0].split():
            yield f"{path}, line {number}", words


def _vertex(values: Sequence[str], where: str) -> list[float]:
    try:
        x, y, z = (float(value) for value in values[:3])
    except ValueError as error:
        raise GarmentError(
            f"{where} is a broken vertex line, three numbers are needed and not {' '.join(values)!r}; export it again"
        ) from error
    return [x, y, z]


def _polygon(values: Sequence[str], before: int, where: str) -> list[int]:
    """Corners of a face, counted from 0; the file counts from 1, or back from the end with negative numbers."""
    corners = list[int]()
    for value in values:
        try:
            number = int(value.partition("/")[0])
        except ValueError as error:
            raise GarmentError(f"{where}: a face names vertices, not {value!r}; export it again") from error
        corner = number - 1 if number > 0 else before + number
        if number == 0 or corner < 0:
            raise GarmentError(f"{where}: a face names vertex {number}; vertices count from 1; export it again")
        if corner != (corners[-1] if corners else None):
            corners.append(corner)
    if len(corners) < 3:
        raise GarmentError(f"{where}: a face needs three corners, not {len(corners)}; export it as a surface")
    return corners


class _Cut:
    """Polygons cut into triangles.

    Where a cut ends at two corners that a seam joins with another polygon, that may be cut there too, and the edge
    would belong to four triangles; so each cut gets a vertex of its own in its middle.
    """

    def __init__(self, vertices: Floats) -> None:
        self._vertices = vertices
        self.faces: list[tuple[int, int, int]] = []
        self.middles: list[Floats] = []

    def add(self, corners: Sequence[int], where: str) -> None:
        """Cut a polygon. Raises GarmentError if it has a corner that is not in the file."""
        if max(corners) >= len(self._vertices):
            raise GarmentError(
                f"{where}: a face names vertex {max(corners) + 1} of {len(self._vertices)}; the file is cut off or "
                "damaged, export it again"
            )
        if len(corners) == 3:
            self.faces.append((corners[0], corners[1], corners[2]))
            return
        ears = [tuple(corners[at] for at in ear) for ear in _ears(_in_plane(self._vertices[list(corners)]))]
        sides = {frozenset(side) for ear in ears for side in _sides(ear)}
        rim = {frozenset(side) for side in _sides(corners)}
        middle = {side: self._middle(*side) for side in sorted(sides - rim, key=sorted)}
        for ear in ears:
            self._split([middle.get(frozenset(side)) for side in _sides(ear)], ear)

    def _middle(self, a: int, b: int) -> int:
        self.middles.append((self._vertices[a] + self._vertices[b]) / 2)
        return len(self._vertices) + len(self.middles) - 1

    def _split(self, middles: Sequence[int | None], ear: Sequence[int]) -> None:
        """A triangle with vertices in the middle of some of its sides, as smaller ones."""
        ring = [vertex for pair in zip(ear, middles, strict=True) for vertex in pair if vertex is not None]
        if len(ring) == 6:
            a, ab, b, bc, c, ca = ring
            self.faces += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
            return
        # Seen from the middle of a side, none of the smaller triangles is flat.
        begin = next((at for at, vertex in enumerate(ring) if vertex in middles), 0)
        ring = ring[begin:] + ring[:begin]
        self.faces += [(ring[0], b, c) for b, c in pairwise(ring[1:])]


def _sides(corners: Sequence[int]) -> Iterator[tuple[int, int]]:
    return zip(corners, [*corners[1:], corners[0]], strict=True)


def _in_plane(points: Floats) -> Floats:
    """A polygon in the plane that it lies in, seen from where it turns anticlockwise, shape (N, 2)."""
    following = np.roll(points, -1, axis=0)
    normal = np.cross(points, following).sum(0)  # Newell's
    length = np.linalg.norm(normal)
    normal = normal / length if length > 0 else np.array([0.0, 0.0, 1.0])
    right = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    right /= np.linalg.norm(right)
    return points @ np.column_stack([right, np.cross(normal, right)])


def _ears(points: Floats) -> Iterator[tuple[int, int, int]]:
    """A polygon cut into triangles, each of neighbours whose triangle holds no other corner: its ears, one by one.

    Of several ears the one with the largest smallest angle is cut, which keeps slivers away.
    """
    left = list(range(len(points)))
    while len(left) > 3:
        best = max(range(len(left)), key=lambda at: _worth(points, left, at))
        yield left[best - 1], left[best], left[(best + 1) % len(left)]
        del left[best]
    yield left[0], left[1], left[2]


def _worth(points: Floats, left: Sequence[int], at: int) -> float:
    """The smallest angle of the triangle at a corner [rad]; less than zero where it is no ear."""
    chosen = (left[at - 1], left[at], left[(at + 1) % len(left)])
    a, b, c = points[list(chosen)]
    if _turn(a, b, c) <= 0:
        return -2.0
    others = points[[corner for corner in left if corner not in chosen]]
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    apart = ~((others == a) | (others == b) | (others == c)).all(-1) if len(others) else inside
    if (inside & apart).any():
        return -1.0
    sides = np.array([b - a, c - b, a - c])
    lengths = np.linalg.norm(sides, axis=1)
    cosines = -(sides * np.roll(sides, 1, axis=0)).sum(1) / (lengths * np.roll(lengths, 1))
    return float(np.arccos(np.clip(cosines, -1, 1)).min())


def _turn(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the signed area of triangles; ``c`` may be many points, shape (..., 2)."""
    return (b[0] - a[0]) * (c[..., 1] - a[1]) - (b[1] - a[1]) * (c[..., 0] - a[0])


WELD = 5e-4
"""Vertices on open edges count as one that are nearer than this share of the garment's longest side."""


def welded(surface: ObjFile) -> tuple[ObjFile, int, float]:
    """The surface with its open edges joined where they nearly meet.

    Returns:
        The surface, with as many vertices in the same order; how many were joined to another; the widest gap.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    edges = np.sort(np.vstack([surface.faces[:, [0, 1]], surface.faces[:, [1, 2]], surface.faces[:, [2, 0]]]), axis=1)
    found, owners = np.unique(edges, axis=0, return_counts=True)
    rim = np.unique(found[owners == 1])
    reach = WELD * float(np.ptp(surface.vertices, axis=0).max())
    pairs = KDTree(surface.vertices[rim]).query_pairs(reach, output_type="ndarray")
    if not len(pairs):
        return surface, 0, 0.0
    gap = float(np.linalg.norm(np.subtract(*surface.vertices[rim[pairs.T]]), axis=1).max())
    count = len(surface.vertices)
    joined = coo_matrix((np.ones(len(pairs)), rim[pairs.T]), (count, count))
    _, label = connected_components(joined, directed=False)
    first = np.full(label.max() + 1, count)
    np.minimum.at(first, label, np.arange(count))
    stands_for = first[label]
    return replace(surface, faces=stands_for[surface.faces]), int((stands_for != np.arange(count)).sum()), gap
