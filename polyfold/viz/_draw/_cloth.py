"""Simulated cloth for people to look at: larger than the camera's picture, with what tells one side from the other.

The back of a garment with two panels is paler than its front and the inside paler still; a weave, a hem and soft
shadows under edges show which way a part lies and what lies on what. No agent sees any of it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment, Mesh
from polyfold.types import SimState
from polyfold.viz._draw._style import Colour

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

TABLE = (236, 236, 232)
BACK = 0.34
"""How much paler the back is than the front, as a share of the way to white."""
WEAVE, WEAVE_DEPTH = 0.008, 0.022
"""Period [m] and contrast of the weave."""
HEM, STITCH, STITCH_DEPTH = 0.012, 0.0022, 0.16
"""Where the hem's seam is [m] from the edge, how wide it is drawn [m], and how dark."""
SHADOW, SHADOW_STEP, SHADOW_DEPTH = 0.010, 0.004, 0.30
"""Width of the shadow under an edge [m], the step that casts a full one [m], and how dark that is."""
LIGHT = np.array([-0.35, 0.40, 0.847])
AMBIENT, DIFFUSE = 0.66, 0.38
_SHIFT = 4
"""Fraction bits of the corners that OpenCV fills triangles from."""


def cloth_picture(state: SimState, garment: Garment, zoom: float = 2.0, oversample: int = 2) -> Image:
    """The cloth as it lies, seen by its camera.

    Args:
        state: where its particles are; known.
        garment: what it is.
        zoom: size relative to the camera's picture.
        oversample: samples per pixel and axis; with 1 edges are jagged, in a third of the time.

    Returns:
        uint8, shape (zoom H, zoom W, 3).
    """
    import cv2

    camera, mesh = state.camera, garment.mesh
    scale = zoom * oversample
    size = round(camera.width * scale), round(camera.height * scale)
    corners = (camera.to_pixels(state.positions) + 0.5) * scale - 0.5
    seen = _seen_triangles(corners, state.positions[:, 2], mesh.triangles, size)
    cloth = seen >= 0
    heights = np.zeros(seen.shape, np.float32)
    picture = np.empty((*seen.shape, 3), np.float32)
    picture[:] = TABLE
    if cloth.any():
        triangles = mesh.triangles[seen[cloth]]
        weights = _barycentric(np.argwhere(cloth)[:, ::-1], corners[triangles])
        heights[cloth] = _blended(weights, state.positions[triangles, 2][..., None])[:, 0]
        colours = _colours(garment)[_sides(state, mesh, seen, oversample)[cloth]]
        picture[cloth] = colours * _tones(state, mesh, triangles, weights)[:, None]
    picture *= (1.0 - _shadows(heights, scale * camera.pixels_per_metre))[..., None]
    width, height = round(camera.width * zoom), round(camera.height * zoom)
    return cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA).clip(0, 255).astype(np.uint8)


def _seen_triangles(
    corners: Floats, heights: Floats, triangles: NDArray[np.int32], size: tuple[int, int]
) -> NDArray[np.int32]:
    """Which triangle is on top at each pixel, -1 for none, shape (H, W): drawn from the lowest up."""
    import cv2

    seen = np.full((size[1], size[0]), -1, np.int32)
    fixed = np.rint(corners * (1 << _SHIFT)).astype(np.int32)
    for number in np.argsort(heights[triangles].mean(axis=1), kind="stable").tolist():
        cv2.fillConvexPoly(seen, fixed[triangles[number]], number, cv2.LINE_8, _SHIFT)
    return seen


def _barycentric(points: NDArray[np.int64], corners: Floats) -> Floats:
    """Weights of the corners, shape (P, 3, 2), of each pixel's triangle, shape (P, 3), within it."""
    first, across, down = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = across[:, 0] * down[:, 1] - across[:, 1] * down[:, 0]
    area = np.where(np.abs(area) < 1e-6, 1e-6, area)
    to = points - first
    second = (to[:, 0] * down[:, 1] - to[:, 1] * down[:, 0]) / area
    third = (across[:, 0] * to[:, 1] - across[:, 1] * to[:, 0]) / area
    weights = np.clip(np.stack([1.0 - second - third, second, third], axis=1), 0.0, 1.0)
    return weights / weights.sum(axis=1, keepdims=True)


def _blended(weights: Floats, values: Floats) -> Floats:
    """Values at pixels, shape (P, K), from those at the corners of their triangles, shape (P, 3, K)."""
    return np.einsum("pc,pck->pk", weights, values)


def _sides(state: SimState, mesh: Mesh, seen: NDArray[np.int32], oversample: int) -> NDArray[np.uint8]:
    """What is seen at each pixel: the front 0, the back 1, the inside 2; shape (H, W), anything where no cloth is.

    A few pixels of another side are where plies that touch are drawn in the wrong order, and are left out.
    """
    import cv2

    upright = _faces_up(state.positions, mesh.triangles)
    outside = upright == ((mesh.panel == 1) | (mesh.layers == 1))
    of_triangles = np.where(outside, np.where((mesh.panel == 1) | (mesh.layers == 1), 0, 1), 2).astype(np.uint8)
    found = of_triangles[seen]
    # A median is one of the values around, and the commonest of two.
    return np.asarray(cv2.medianBlur(found, 2 * oversample + 1), np.uint8)


def _tones(state: SimState, mesh: Mesh, triangles: NDArray[np.int32], weights: Floats) -> Floats:
    """How light pixels on the cloth are, shape (P,), by the light, the weave and the hem."""
    normals = _normals(state.positions, mesh.triangles)
    facing = _blended(weights, normals[triangles])
    facing /= np.linalg.norm(facing, axis=1, keepdims=True) + 1e-9
    light = AMBIENT + DIFFUSE * np.abs(facing @ LIGHT)
    place = _blended(weights, np.column_stack([mesh.vertices, _from_edge(mesh)])[triangles])
    weave = np.sin(2 * np.pi / WEAVE * place[:, 0]) * np.sin(2 * np.pi / WEAVE * place[:, 1])
    stitch = np.clip(1.0 - np.abs(place[:, 2] - HEM) / STITCH, 0.0, 1.0)
    return light * (1.0 + WEAVE_DEPTH * weave) * (1.0 - STITCH_DEPTH * stitch)


def sides_of(garment: Garment) -> list[tuple[str, Colour]]:
    """What the sides of a garment are called, with the colours that they are drawn in."""
    front, back, inside = (tuple(colour.round().astype(int).tolist()) for colour in _colours(garment))
    return [("front", front), ("back", back)] if garment.mesh.layers == 2 else [("one side", front), ("other", inside)]


def _colours(garment: Garment) -> Floats:
    """Of the front, the back and the inside, shape (3, 3); of a single cloth both first are its outside."""
    outside, inside = (np.array(colour, float) for colour in garment.colours)
    back = outside if garment.mesh.layers == 1 else outside + BACK * (255.0 - outside)
    return np.stack([outside, back, inside])


def _normals(positions: Floats, triangles: NDArray[np.int32]) -> Floats:
    """Normals of particles, the mean of their triangles', shape (N, 3)."""
    a, b, c = positions[triangles.T]
    of_triangles = np.cross(b - a, c - a)
    found = np.zeros_like(positions)
    for corner in triangles.T:
        np.add.at(found, corner, of_triangles)
    return found / (np.linalg.norm(found, axis=1, keepdims=True) + 1e-12)


def _faces_up(positions: Floats, triangles: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Whether the side of a triangle that was up at rest is up now, shape (T,)."""
    a, b, c = positions[triangles.T][..., :2]
    (u, v), (x, y) = (b - a).T, (c - a).T
    return u * y - v * x > 0


@lru_cache(maxsize=8)
def _from_edge(mesh: Mesh) -> Floats:
    """How far particles are from the outline at rest [m], shape (N,)."""
    from scipy.spatial import KDTree

    ring = mesh.vertices[mesh.boundary]
    ahead = np.roll(ring, -1, axis=0)
    dense = np.concatenate([ring + share * (ahead - ring) for share in np.linspace(0.0, 1.0, 8, endpoint=False)])
    return KDTree(dense).query(mesh.vertices)[0]


def _shadows(heights: NDArray[np.float32], pixels_per_metre: float) -> NDArray[np.float32]:
    """How much darker it is at each pixel for what stands higher beside it, 0 to 1."""
    import cv2

    around = cv2.GaussianBlur(heights, (0, 0), max(SHADOW * pixels_per_metre / 2, 0.5))
    return SHADOW_DEPTH * np.clip((around - heights) / SHADOW_STEP, 0.0, 1.0)
