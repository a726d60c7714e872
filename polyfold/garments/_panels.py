"""From outline to mesh: one panel, or a front and a back that are sewn along their seams and open elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError
from polyfold.garments._garment import Mesh
from polyfold.garments._outline import Outline

Floats = NDArray[np.float64]
Triangles = NDArray[np.int32]

FINEST, COARSEST = 1 / 600, 1 / 4  # edge length as a share of the garment's longest side
CLEARANCE = 0.62  # smallest distance of a lattice point from the outline, in edge lengths
SMOOTHING_ROUNDS = 4
FLAT = 1e-6  # doubled area, in squared edge lengths, of what joins three points on a straight stretch of the outline
INSETS = (0.0, 0.15, 0.3)  # in edge lengths, tried in turn


def mesh_panels(outline: Outline, layers: int, edge_length: float) -> tuple[Mesh, dict[str, int]]:
    """Mesh an outline with well-shaped triangles of about ``edge_length`` [m].

    A hexagonal lattice fills the inside, evenly spaced points the outline; every named corner is a vertex. With two
    layers, front and back are the same triangulation and share the vertices along the outline, except strictly inside
    the openings, where each has its own.

    Returns:
        The mesh, and corner name -> vertex; the top panel's vertex where the garment is open.

    Raises:
        GarmentError: if the outline is too fine or too thin for the edge length, or crosses itself.
    """
    if layers not in (1, 2):
        raise GarmentError(f"a garment has 1 or 2 layers, not {layers}")
    _check_edge_length(edge_length, float(np.ptp(outline.points, axis=0).max()))
    outline = outline.counter_clockwise()
    ring, corners = _resampled(outline, edge_length)
    points, triangles = _triangulate(ring, edge_length)
    sewn = _sewn(len(ring), corners, outline.openings)
    if layers == 1:
        return _one_layer(points, triangles, len(ring)), corners
    points, triangles = _without_chords(points, triangles, sewn, edge_length)
    mesh, top = _two_layers(points, triangles, len(ring), sewn)
    return mesh, {name: int(top[index]) for name, index in corners.items()}


def _check_edge_length(edge_length: float, size: float) -> None:
    if not COARSEST * size > edge_length > FINEST * size:
        raise GarmentError(
            f"an edge length of {edge_length} m does not suit a garment of {size:.2f} m; "
            f"choose one between {FINEST * size:.4f} and {COARSEST * size:.2f} m, such as 0.0125"
        )


def _resampled(outline: Outline, edge_length: float) -> tuple[Floats, dict[str, int]]:
    """Points about an edge length apart along the outline, exact at the corners; corner name -> index among them."""
    points = outline.points
    order = sorted(outline.corners, key=lambda name: outline.corners[name])
    stops = [outline.corners[name] for name in order] or [0]
    pieces: list[Floats] = []
    indices: dict[str, int] = {}
    count = 0
    for position, start in enumerate(stops):
        end = stops[(position + 1) % len(stops)]
        span = np.arange(start, end + 1 if end > start else end + len(points) + 1) % len(points)
        piece = _evenly(points[span], edge_length, at_least=1 if len(stops) > 2 else 3)
        if order:
            indices[order[position]] = count
        pieces.append(piece)
        count += len(piece)
    return np.vstack(pieces), indices


def _evenly(polyline: Floats, edge_length: float, at_least: int) -> Floats:
    """The polyline resampled evenly, its last point left out."""
    position = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(polyline, axis=0).T))])
    count = max(at_least, round(position[-1] / edge_length))
    at = np.linspace(0.0, position[-1], count, endpoint=False)
    return np.column_stack([np.interp(at, position, polyline[:, 0]), np.interp(at, position, polyline[:, 1])])


def _triangulate(ring: Floats, edge_length: float) -> tuple[Floats, Triangles]:
    """Vertices (the ring first, then the inside) and counter-clockwise triangles of a simple polygon."""
    import shapely

    polygon = shapely.Polygon(ring)
    if not polygon.is_valid:
        raise GarmentError(
            f"the outline crosses itself at an edge length of {edge_length:.4f} m; use a finer edge length or repair it"
        )
    inside = _lattice_inside(polygon, edge_length)
    points = np.vstack([ring, inside])
    for _ in range(SMOOTHING_ROUNDS):
        triangles = _conforming(points, len(ring), polygon, edge_length)
        points = _smoothed(points, triangles, len(ring), polygon, edge_length)
    return points, _conforming(points, len(ring), polygon, edge_length)


def _lattice_inside(polygon, edge_length: float) -> Floats:
    """Points of a hexagonal lattice that keep clear of the outline, shape (K, 2)."""
    import shapely

    x_min, y_min, x_max, y_max = polygon.bounds
    row = edge_length * np.sqrt(3.0) / 2.0
    half_columns = int(np.ceil((x_max - x_min) / edge_length / 2)) + 1
    half_rows = int(np.ceil((y_max - y_min) / row / 2)) + 1
    column, line = np.meshgrid(np.arange(-half_columns, half_columns + 1), np.arange(-half_rows, half_rows + 1))
    x = (x_min + x_max) / 2 + (column + 0.5 * (line % 2)) * edge_length
    y = (y_min + y_max) / 2 + line * row
    core = polygon.buffer(-CLEARANCE * edge_length)
    keep = shapely.contains_xy(core, x.ravel(), y.ravel())
    return np.column_stack([x.ravel()[keep], y.ravel()[keep]])


def _conforming(points: Floats, ring_size: int, polygon, edge_length: float) -> Triangles:
    """Delaunay triangles inside the polygon, with every edge of the ring among their edges.

    Where two stretches of the outline nearly touch (the legs of trousers below the crotch), plain Delaunay may join
    them across the gap. Triangulating with the ring drawn in a little widens the gap; the topology then holds for the
    true positions as well.
    """
    import shapely
    from scipy.spatial import Delaunay

    ring = points[:ring_size]
    for inset in INSETS:
        moved = points.copy()
        moved[:ring_size] += inset * edge_length * _inward(ring)
        triangles = Delaunay(moved).simplices.astype(np.int32)
        contour = shapely.Polygon(moved[:ring_size]) if inset else polygon
        if not contour.is_valid:
            continue
        middle = moved[triangles].mean(1)
        triangles = triangles[shapely.contains_xy(contour, middle[:, 0], middle[:, 1])]
        triangles = _counter_clockwise(points, triangles)
        triangles = triangles[_doubled_areas(points, triangles) > FLAT * edge_length**2]
        if _covers(points, triangles, ring_size, polygon.area):
            return triangles
    raise GarmentError(
        f"the outline has parts too thin for an edge length of {edge_length:.4f} m; use a finer edge length"
    )


def _inward(ring: Floats) -> Floats:
    """Unit normals that point into a counter-clockwise ring, shape (R, 2)."""
    along = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    return np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(np.hypot(*along.T), 1e-12)[:, None]


def _doubled_areas(points: Floats, triangles: Triangles) -> Floats:
    a, b, c = points[triangles].transpose(1, 0, 2)
    return (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])


def _counter_clockwise(points: Floats, triangles: Triangles) -> Triangles:
    turned = triangles.copy()
    clockwise = _doubled_areas(points, triangles) < 0
    turned[clockwise, 1], turned[clockwise, 2] = triangles[clockwise, 2], triangles[clockwise, 1]
    return turned


def _covers(points: Floats, triangles: Triangles, ring_size: int, area: float) -> bool:
    """Whether the triangles tile the polygon: each ring edge belongs to exactly one, every vertex to some."""
    directed = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = len(points)
    codes = directed[:, 0] * size + directed[:, 1]
    ring = np.arange(ring_size)
    has_ring = np.isin(ring * size + (ring + 1) % ring_size, codes).all()
    complete = len(np.unique(triangles)) == size
    total = 0.5 * np.abs(_doubled_areas(points, triangles)).sum()
    return bool(has_ring and complete and abs(total - area) < 1e-6 * area)


def _smoothed(points: Floats, triangles: Triangles, ring_size: int, polygon, edge_length: float) -> Floats:
    """The inner points near the outline moved to the middle of their neighbours; the lattice elsewhere stays put."""
    import shapely

    directed = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    undirected = np.vstack([directed, directed[:, ::-1]])
    neighbours = np.bincount(undirected[:, 0], minlength=len(points))
    middle = np.column_stack(
        [np.bincount(undirected[:, 0], points[undirected[:, 1], axis], len(points)) / neighbours for axis in (0, 1)]
    )
    deep = polygon.buffer(-2.5 * edge_length)
    free = ~shapely.contains_xy(deep, points[:, 0], points[:, 1])
    free[:ring_size] = False
    moved = points.copy()
    moved[free] = middle[free]
    return moved


def _sewn(ring_size: int, corners: dict[str, int], openings: tuple[tuple[str, str], ...]) -> NDArray[np.bool_]:
    """Which ring points are seam: all but those strictly inside an opening, shape (ring_size,)."""
    sewn = np.ones(ring_size, bool)
    for start, end in openings:
        missing = [name for name in (start, end) if name not in corners]
        if missing:
            raise GarmentError(f"an opening names no corner {missing[0]!r}; use two of {', '.join(corners)}")
        first, last = corners[start], corners[end]
        sewn[np.arange(first + 1, last if last > first else last + ring_size) % ring_size] = False
    return sewn


def _without_chords(
    points: Floats, triangles: Triangles, sewn: NDArray[np.bool_], edge_length: float
) -> tuple[Floats, Triangles]:
    """Remove inner edges between two seam vertices: they would weld front and back together along a line.

    They appear where a sharp corner is cut off by one triangle. The edge is turned to the other diagonal if that
    gives two proper triangles, and split at its middle otherwise.
    """
    on_seam = np.zeros(len(points), bool)
    on_seam[: len(sewn)] = sewn
    faces = [tuple(int(vertex) for vertex in face) for face in triangles]
    added: list[Floats] = []
    chords = _chords(triangles, on_seam, len(sewn))
    for a, b in chords:
        left = next((k for k, face in enumerate(faces) if _has_edge(face, a, b)), None)
        right = next((k for k, face in enumerate(faces) if _has_edge(face, b, a)), None)
        if left is None or right is None:
            continue  # an earlier turn has removed it
        c = next(vertex for vertex in faces[left] if vertex not in (a, b))
        d = next(vertex for vertex in faces[right] if vertex not in (a, b))
        turned = np.array([[a, d, c], [d, b, c]], np.int32)
        every = np.vstack([points, *added])
        if not (on_seam[c : c + 1].any() and on_seam[d : d + 1].any()) and _well_shaped(every, turned):
            faces[left], faces[right] = (a, d, c), (d, b, c)
        else:
            middle = len(every)
            added.append((every[a] + every[b])[None] / 2)
            faces[left], faces[right] = (a, middle, c), (middle, b, c)
            faces += [(b, middle, d), (middle, a, d)]
    points, triangles = np.vstack([points, *added]), np.array(faces, np.int32)
    return (_relaxed(points, triangles, len(sewn), edge_length) if chords else points), triangles


def _relaxed(points: Floats, triangles: Triangles, ring_size: int, edge_length: float) -> Floats:
    """The inner points near the outline evened out without changing the triangles, as far as none turns over."""
    import shapely

    polygon = shapely.Polygon(points[:ring_size])
    for _ in range(SMOOTHING_ROUNDS):
        moved = _smoothed(points, triangles, ring_size, polygon, edge_length)
        if not _well_shaped(moved, triangles, least_degrees=10.0):
            break
        points = moved
    return points


def _chords(triangles: Triangles, on_seam: NDArray[np.bool_], ring_size: int) -> list[tuple[int, int]]:
    """Inner edges (a < b) with both ends on the seam."""
    directed = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    chord = on_seam[directed].all(1) & (directed[:, 0] < directed[:, 1])
    step = directed[:, 1] - directed[:, 0]
    chord &= (step != 1) & (step != ring_size - 1)
    return [(int(a), int(b)) for a, b in directed[chord]]


def _has_edge(face: tuple[int, ...], start: int, end: int) -> bool:
    return (start, end) in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0]))


def _well_shaped(points: Floats, triangles: Triangles, least_degrees: float = 18.0) -> bool:
    """Whether the triangles run counter-clockwise and have no angle below the limit."""
    if (_doubled_areas(points, triangles) <= 0).any():
        return False
    corner = points[triangles]
    along, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    cosine = (along * back).sum(-1) / (np.linalg.norm(along, axis=-1) * np.linalg.norm(back, axis=-1))
    return bool((cosine < np.cos(np.radians(least_degrees))).all())


def _one_layer(points: Floats, triangles: Triangles, ring_size: int) -> Mesh:
    return Mesh(
        vertices=points,
        triangles=triangles,
        panel=np.zeros(len(triangles), np.int8),
        layer=np.zeros(len(points), np.int8),
        seam=np.zeros(len(points), bool),
        boundary=np.arange(ring_size, dtype=np.int32),
    )


def _two_layers(
    points: Floats, triangles: Triangles, ring_size: int, sewn: NDArray[np.bool_]
) -> tuple[Mesh, NDArray[np.int32]]:
    """The mesh, and for each vertex of the bottom panel the one above it (itself on the seam)."""
    size = len(points)
    seam = np.zeros(size, bool)
    seam[:ring_size] = sewn
    top = np.arange(size, dtype=np.int32)
    top[~seam] = size + np.arange((~seam).sum(), dtype=np.int32)
    extra = int((~seam).sum())
    mesh = Mesh(
        vertices=np.vstack([points, points[~seam]]),
        triangles=np.vstack([triangles, top[triangles]]).astype(np.int32),
        panel=np.repeat(np.array([0, 1], np.int8), len(triangles)),
        layer=np.concatenate([np.zeros(size, np.int8), np.ones(extra, np.int8)]),
        seam=np.concatenate([seam, np.zeros(extra, bool)]),
        boundary=top[:ring_size],
    )
    return mesh, top
