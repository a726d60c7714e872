"""Cusick's drape (BS 5058, ISO 9073-9): how much of a disc's overhang still shades what is below it?

A disc of 300 mm lies on a pedestal of 180 mm. The drape coefficient is the share of the overhanging ring's area that
the draped disc covers, seen from above. Real fabrics bend with internal friction and stop earlier than elastic ones.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import RESTLESS, Cloth
from experiments.benchmarks.cloth.reality.rows import Row, percent
from experiments.benchmarks.cloth.reality.sheets import ROW, disc, lifted
from polyfold.garments import Fabric

DISC, PEDESTAL = 0.15, 0.09
"""Radii [m]."""
HEIGHT = 0.1
"""Of the pedestal [m]."""
PIXELS_PER_METRE = 2500
UNEVENNESS = 0.0005
"""Standard deviation of the particles' first heights [m]: a perfectly even disc would not know where to fold."""
DISCS = 3
PUBLISHED = {
    "jersey": "range 18–31 % (250 mm discs; cited second-hand)",
    "poplin": "range 48–80 % (plain weaves, Vlákna a textil 1/2018), 68 % (cotton, doi 10.1080/00405009108658741), "
    "83 % (cotton broadcloth, B 1.2e-5 N·m, J. Text. Eng. 61(6) 2015); all cited second-hand",
    "denim": "none found for denim; 80 % for a 3/1 twill of .25 kg/m² (Vlákna a textil 1/2018, cited second-hand)",
}
"""What could be found; second-hand is what was read in other works than the source."""
ANY_FABRIC = "25 fabrics: 15–91 %, median 65 (projected from the drape meshes of arXiv 2402.17664)"
"""Those fabrics' bending lengths are not with the meshes."""


def drape_coefficient(shadow: float) -> float:
    """Share of the overhanging ring that a shadow of this area [m²], pedestal included, covers."""
    return (shadow / np.pi - PEDESTAL**2) / (DISC**2 - PEDESTAL**2)


def shadow(positions: NDArray[np.float64], triangles: NDArray[np.int32]) -> float:
    """Area [m²] that triangles, shape (T, 3), with corners at positions [m], shape (N, 3), cover seen from above."""
    import cv2

    size = 2 * round(1.2 * DISC * PIXELS_PER_METRE)
    picture = np.zeros((size, size), np.uint8)
    corners = np.round((positions[:, :2] * PIXELS_PER_METRE + size / 2) * 16).astype(np.int32)
    for triangle in corners[triangles]:
        cv2.fillConvexPoly(picture, triangle, 1, shift=4)
    # Every pixel that the outline touches is filled: half a pixel too much all around.
    contours, _ = cv2.findContours(picture, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return float(sum(cv2.contourArea(contour) for contour in contours)) / PIXELS_PER_METRE**2


def drape(fabric: Fabric, edge_length: float, seed: int = 0) -> tuple[float, float]:
    """Drape coefficient of one disc of a fabric, and how fast it still moves, RMS [m/s]."""
    mesh = disc(DISC, edge_length)
    # Bends are spread half a row to both sides of the outermost row that is held, which lies half a row inside on
    # average; so that the cloth bends from the pedestal's rim on, all within one row more is held.
    held = np.hypot(*mesh.vertices.T) <= PEDESTAL + ROW * edge_length
    start = lifted(mesh.vertices, HEIGHT)
    start[~held, 2] += np.random.default_rng(seed).normal(0.0, UNEVENNESS, int((~held).sum()))
    cloth = Cloth(mesh, fabric, start)
    cloth.pin(np.flatnonzero(held))
    speed = cloth.rest(4.0)
    return drape_coefficient(shadow(cloth.positions(), mesh.triangles)), speed


def drape_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """The drape coefficient."""
    found, speed = np.array([drape(fabric, edge_length, seed) for seed in range(DISCS)]).T
    known = [PUBLISHED[fabric.name]] if fabric.name in PUBLISHED else []
    published = "; ".join([*known, ANY_FABRIC])
    ours = f"{percent(float(found.mean()))} ± {percent(float(found.std()))}"
    if speed.max() > RESTLESS:
        ours += f", never at rest ({1000 * speed.max():.0f} mm/s)"
    yield Row("drape", fabric.name, "drape coefficient, 300 mm over 180 mm", published, ours, f"{DISCS} discs")
