"""Garments from triangle meshes: an OBJ file and its keypoints, laid flat, cut out and sewn anew."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError
from polyfold.errors._hints import file_problem
from polyfold.garments._flatten import flatten, front_faces
from polyfold.garments._garment import Garment
from polyfold.garments._obj_file import ObjFile, read_obj, welded
from polyfold.garments._pattern import Pattern
from polyfold.garments._twin import twin_from_outline

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]

DISTORTION = 0.15
"""Largest accepted change of edge length by flattening, at the 95th percentile."""

FLIPPED = 0.05
"""Largest accepted share of the surface that turns over when it is flattened."""

USUAL = (0.55, 4.0)
"""Longest sides of a mesh that is taken to be in metres, as multiples of what is typical of the kind."""

LONGEST = 2.5
"""The longest of those [m]."""


def load_obj(
    path: str | Path,
    keypoints_json: str | Path,
    kind: str,
    pattern: Pattern,
    size_m: float | None = None,
    edge_length: float | None = None,
) -> Garment:
    """Build a garment from a mesh, such as a shirt in T-pose.

    The front and back of the mesh are pressed flat with as little stretch as possible; the flat silhouette is then
    meshed evenly and sewn like any other garment of its kind, so that it simulates as well whatever the triangles of
    the file are like. Up, right and the viewer's side follow from the keypoints.

    Args:
        path: a triangle or polygon mesh in one connected piece.
        keypoints_json: JSON object: keypoint name -> vertex, counted from 0 in the order of the file's ``v`` lines;
            all names of the kind, left and right as a viewer in front of it sees them.
        kind: registered garment kind.
        pattern: how the garment is sewn.
        size_m: longest side of the flat garment's bounding box [m]; by default the file is in metres.
        edge_length: mesh size [m]; by default 10 mm for one layer, 12.5 mm for two.

    Raises:
        GarmentError: if the mesh is unusable, a keypoint is missing or unknown, or the mesh does not lie flat.
    """
    path = Path(path)
    surface, unit = _of_unit_size(read_obj(path), path)
    indices = _keypoint_indices(Path(keypoints_json), pattern, surface.listed)
    vertices, faces = _sound_mesh(surface, path)
    corners = _nearest(vertices, surface.vertices[list(indices.values())])
    places = dict(zip(indices, corners, strict=True))
    right, up, viewer = _frame({name: vertices[vertex] for name, vertex in places.items()}, pattern, path)
    front = front_faces(vertices, faces, viewer) if pattern.layers == 2 else np.ones(len(faces), bool)
    if front.all() and pattern.layers == 2:
        raise GarmentError(f"{path} has no back; a {kind} needs a closed body with openings")
    flat = flatten(vertices, faces, front, right, up)
    _check_flat(flat.distortion, flat.flipped, path)
    size = _size(unit * float(np.ptp(flat.points, axis=0).max()), size_m, kind, pattern, path)
    pixels = flat.points * np.array([1.0, -1.0])
    outline = _silhouette(pixels, faces, front)
    keypoints = {name: pixels[vertex] for name, vertex in places.items()}
    return twin_from_outline(outline, kind, keypoints, pattern, size, edge_length, name=path.stem)


def _of_unit_size(surface: ObjFile, path: Path) -> tuple[ObjFile, float]:
    """The surface with its longest side scaled to 1, since a library's tolerances suit that; and how long that was."""
    unit = float(np.ptp(surface.vertices, axis=0).max())
    if unit <= 0:
        raise GarmentError(f"all vertices of {path} lie in one place; export it again")
    return replace(surface, vertices=(surface.vertices - surface.vertices.mean(0)) / unit), unit


def _keypoint_indices(path: Path, pattern: Pattern, count: int) -> dict[str, int]:
    try:
        content: Any = json.loads(path.read_text("utf-8-sig"))
    except OSError as error:
        raise GarmentError(file_problem(error, path)) from error
    except (ValueError, RecursionError) as error:
        raise GarmentError(f"the keypoints {path} are no JSON ({error}); write a JSON object name -> vertex") from error
    if not isinstance(content, Mapping) or not content:
        raise GarmentError(f"{path} holds no keypoints; write a JSON object name -> vertex index")
    missing = [name for name in pattern.corners if name not in content]
    unknown = [name for name in content if name not in pattern.corners]
    if missing or unknown:
        problems = [
            f"{word}: {', '.join(names)}" for word, names in (("missing", missing), ("unknown", unknown)) if names
        ]
        raise GarmentError(f"wrong keypoints in {path} ({'; '.join(problems)}); name {', '.join(pattern.corners)}")
    for name, index in content.items():
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < count:
            raise GarmentError(
                f"the keypoint {name} in {path} is no vertex of the mesh: {index!r}; use 0 to {count - 1}"
            )
    shared = [name for name, index in content.items() if list(content.values()).count(index) > 1]
    if shared:
        raise GarmentError(f"the keypoints {', '.join(shared)} in {path} name one vertex; give each its own")
    return {name: content[name] for name in pattern.corners}


def _sound_mesh(surface: ObjFile, path: Path) -> tuple[Floats, Faces]:
    """Vertices and consistently wound faces of one connected manifold."""

    mesh = _cleaned(surface)
    if len(_large_pieces(mesh)) > 1:
        # In one piece, vertices in one place are front and back; of several, they are seams that were cut open.
        surface, count, gap = welded(surface)
        mesh = _cleaned(surface)
        if gap > 0:
            joined = f"{count} vertices along seams are joined with others up to {gap:.1e} of its size away"
            warnings.warn(f"{path}: {joined}", stacklevel=4)
    _, owners = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    if (owners > 2).any():
        raise GarmentError(
            f"{path} is not a manifold: {(owners > 2).sum()} edges belong to three faces or more; repair it"
        )
    mesh = _largest_piece(mesh, path)
    faces = np.asarray(mesh.faces, np.int64)
    if not mesh.is_winding_consistent:
        faces = _wound_alike(faces, mesh.face_adjacency, mesh.face_adjacency_edges)
    return np.asarray(mesh.vertices, float), faces


def _wound_alike(faces: Faces, neighbours: Faces, shared: Faces) -> Faces:
    """Faces of one piece, all wound as the first is. trimesh 5.2 takes a quarter of a millisecond for each face.

    Args:
        faces: shape (T, 3).
        neighbours: pairs of faces that share an edge, shape (K, 2).
        shared: the vertices of that edge, shape (K, 2).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order

    begins = faces[neighbours] == shared[:, None, :1]
    ahead = (begins & (np.roll(faces, -1, axis=1)[neighbours] == shared[:, None, 1:])).any(axis=2)
    turned = np.where(ahead[:, 0] == ahead[:, 1], -1, 1)
    both = np.concatenate([neighbours, neighbours[:, ::-1]]).T
    relation = coo_array((np.tile(turned, 2), (both[0], both[1])), (len(faces),) * 2).tocsr()
    order, before = breadth_first_order(abs(relation), 0)
    steps = np.asarray(relation[before[order[1:]], order[1:]]).ravel()
    way = np.ones(len(faces), int)
    for face, step in zip(order[1:].tolist(), steps.tolist(), strict=True):
        way[face] = way[before[face]] * step
    return np.where(way[:, None] < 0, faces[:, ::-1], faces)


def _cleaned(surface: ObjFile) -> Any:
    import trimesh

    mesh: Any = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.update_faces(mesh.unique_faces())
    return mesh


def _large_pieces(mesh: Any) -> list[Any]:
    """The pieces of a mesh without loose scraps such as buttons, the largest first."""
    pieces = sorted(mesh.split(only_watertight=False, repair=False), key=lambda piece: -piece.area)
    return [piece for piece in pieces if piece.area > 0.05 * pieces[0].area]


def _largest_piece(mesh: Any, path: Path) -> Any:
    pieces = _large_pieces(mesh)
    if not pieces:
        raise GarmentError(f"the faces of {path} have no area; export it again as a surface")
    if len(pieces) > 1:
        raise GarmentError(f"{path} consists of {len(pieces)} separate pieces; join them, or keep one garment per file")
    piece = pieces[0]
    piece.remove_unreferenced_vertices()
    return piece


def _nearest(vertices: Floats, points: Floats) -> list[int]:
    from scipy.spatial import KDTree

    return [int(index) for index in np.asarray(KDTree(vertices).query(points)[1])]


def _frame(places: Mapping[str, Floats], pattern: Pattern, path: Path) -> tuple[Floats, Floats, Floats]:
    """Unit vectors right, up and towards the viewer, as the keypoints say, each of shape (3,)."""
    up = pattern.up(places)
    pairs = [(name, name.replace("_left", "_right")) for name in pattern.corners if name.endswith("_left")]
    right = np.mean([places[b] - places[a] for a, b in pairs], axis=0)
    size = np.ptp(np.array(list(places.values())), axis=0).max()
    if np.linalg.norm(up) < 0.05 * size:
        raise GarmentError(f"the keypoints of {path} tell no up from down; correct them")
    up /= np.linalg.norm(up)
    right = right - (right @ up) * up
    if np.linalg.norm(right) < 0.05 * size:
        raise GarmentError(f"the keypoints of {path} tell no left from right; correct them")
    right /= np.linalg.norm(right)
    return right, up, np.asarray(np.cross(right, up), float)


def _check_flat(distortion: Floats, flipped: float, path: Path) -> None:
    p95 = float(np.percentile(np.abs(distortion), 95))
    if p95 > DISTORTION or flipped > FLIPPED:
        raise GarmentError(
            f"{path} does not lie flat: edges change length by {100 * p95:.0f} % (95th percentile) and "
            f"{100 * flipped:.0f} % of it turns over; use a garment in T-pose, arms spread and without deep folds"
        )


def _size(size: float, size_m: float | None, kind: str, pattern: Pattern, path: Path) -> float:
    if size_m is not None:
        return size_m
    shortest, longest = USUAL[0] * pattern.size, min(USUAL[1] * pattern.size, LONGEST)
    if not shortest <= size <= longest:
        raise GarmentError(
            f"{path} is {size:.3g} units long; in metres, a {kind} is {shortest:.2g} to {longest:.2g} m long; "
            "give its longest side in metres (--size)"
        )
    return size


def _silhouette(points: Floats, faces: Faces, front: NDArray[np.bool_]) -> Floats:
    """Outer outline of all faces, shape (K, 2)."""
    import shapely

    size = float(np.ptp(points, axis=0).max())
    panels = [_united(points[panel], size) for panel in (faces[front], faces[~front]) if len(panel)]
    union = shapely.union_all(shapely.buffer(panels, _CRACK * size, join_style="mitre"), grid_size=1e-6 * size)
    largest = max(shapely.get_parts(union), key=lambda part: part.area)
    return shapely.get_coordinates(largest.exterior)[:-1]


_CRACK = 1e-4
"""Gaps between faces that are closed, as a share of the size."""


def _united(triangles: Floats, size: float) -> Any:
    """The union of one panel's triangles, shape (T, 3, 2), as a polygon."""
    import shapely

    polygons = shapely.polygons(triangles)
    if shapely.coverage_is_valid(polygons):  # no face lies on another, as a rule: then it takes a tenth of the time
        return shapely.coverage_union_all(polygons)
    return shapely.union_all(shapely.buffer(polygons, _CRACK * size, join_style="mitre"), grid_size=1e-6 * size)
