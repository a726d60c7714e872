"""The hanging heart loop (Peirce 1930; ASTM D1388, option B): for cloth too limp for the cantilever.

Both ends of a strip leave a clamp upwards, turn over and hang; the loop's height says the bending length.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import RESTLESS, Cloth, elastic
from experiments.benchmarks.cloth.reality.elastica import Shape, heart_loop, peirce_heart_loop
from experiments.benchmarks.cloth.reality.rows import Row, millimetres
from experiments.benchmarks.cloth.reality.sheets import strip
from polyfold.garments import Fabric

Floats = NDArray[np.float64]

WIDTH = 0.025
"""Of the strip [m], which is cut along the weft."""
LENGTHS = (0.15, 0.20)
"""Of the loops' strips [m]; the standard has 150, 200 and 250 mm (15 cm for limp cloth)."""
CLAMP = 0.13
"""Height of the clamp [m]: nothing touches the table."""
STIFFER = 2.0
"""The loop starts in the shape of a fabric with a bending length so many times longer, and falls into its own."""


def hang_loop(fabric: Fabric, length: float, edge_length: float) -> tuple[float, float]:
    """Height of a loop of a strip of this length [m] from clamp to lowest point [m], and its speed, RMS [m/s]."""
    # A bend at a row of particles is spread half an edge to both sides: the row that is held counts as clamped only
    # from half an edge behind it. The loop of the theory begins there.
    pinned = length / 2 - edge_length / 2
    mesh = strip(length + edge_length, WIDTH, edge_length, (-pinned, pinned))
    along = mesh.vertices[:, 0]
    start = heart_loop(length, STIFFER * fabric.bending_length_weft, fabric.thickness)
    cloth = Cloth(mesh, fabric, _bent(mesh.vertices, start, length, fabric.thickness))
    cloth.pin(np.flatnonzero(np.abs(along) > pinned - 1e-3 * edge_length))
    speed = cloth.rest(6.0)
    middle = np.abs(along) < 0.75 * edge_length
    return CLAMP - _lowest(along[middle], cloth.positions()[middle, 2]), speed


def heart_loop_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Heights, and what bending length Peirce's formula finds in them."""
    fabric = elastic(fabric)
    asked = fabric.bending_length_weft
    for length in LENGTHS:
        height, speed = hang_loop(fabric, length, edge_length)
        exact = -float(heart_loop(length, asked, fabric.thickness).up[-1])
        by_formula = peirce_heart_loop(height, length)
        ours = f"{millimetres(height)} ({millimetres(height - exact)}), {millimetres(by_formula)} by Peirce's formula"
        yield Row(
            "heart loop",
            fabric.name,
            f"height and bending length, loop of {millimetres(length, 0)}",
            f"{millimetres(exact)} (elastica) for a bending length of {millimetres(asked)}; "
            f"{millimetres(peirce_heart_loop(exact, length))} by Peirce's formula",
            ours if speed <= RESTLESS else f"never at rest ({1000 * speed:.0f} mm/s)",
            "1",
        )


def _bent(flat: Floats, shape: Shape, length: float, gap: float) -> Floats:
    """Positions of the strip's particles [m] along a loop; what is beyond the clamp goes straight down."""
    from_clamp = length / 2 - np.abs(flat[:, 0])
    across, up = shape.at(np.clip(from_clamp, 0.0, None))
    across = np.where(from_clamp < 0, gap / 2, across)
    up = np.where(from_clamp < 0, from_clamp, up)
    side = np.where(flat[:, 0] < 0, -1.0, 1.0)
    return np.column_stack([side * across, flat[:, 1], CLAMP + up])


def _lowest(along: Floats, height: Floats) -> float:
    """The lowest point of a parabola through the particles about the loop's middle [m]."""
    a, b, c = np.polyfit(along, height, 2)
    return float(c - b * b / (4 * a)) if a > 0 else float(height.min())
