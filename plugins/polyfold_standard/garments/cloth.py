"""What squares and rectangles share: a one-layer cloth whose corners are named by how it lies."""

from __future__ import annotations

import numpy as np

from polyfold.garments import Garment, Outline, Pattern, curved_outline, mesh_panels
from polyfold_standard.garments.colours import fabric_colours

CORNERS: tuple[str, ...] = ("bottom_left", "top_left", "top_right", "bottom_right")

CLOTH = Pattern(
    corners=CORNERS, top=("top_left", "top_right"), bottom=("bottom_left", "bottom_right"), size=0.35, cyclic=CORNERS
)


def cloth_outline(width: float, height: float, rng: np.random.Generator) -> Outline:
    """A woven cloth of about this size [m]: rounded corners, edges that bulge and corners off by a few millimetres."""
    square = 0.5 * np.array([[-width, -height], [-width, height], [width, height], [width, -height]])
    corners = dict(zip(CORNERS, square + rng.uniform(-0.004, 0.004, (4, 2)), strict=True))
    neighbours = zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)
    bulges = {pair: float(rng.uniform(-0.003, 0.004)) for pair in neighbours}
    rounding = {name: float(rng.uniform(0.004, 0.012)) for name in CORNERS}
    return curved_outline(corners, bulges=bulges, rounding=rounding)


def cloth_garment(kind: str, seed: int, outline: Outline, edge_length: float, rng: np.random.Generator) -> Garment:
    """Mesh the outline; ``rng`` decides the colours."""
    mesh, keypoints = mesh_panels(outline, 1, edge_length)
    return Garment(kind, f"{kind}-{seed:04d}", seed, mesh, keypoints, fabric_colours(rng), cyclic=CORNERS)
