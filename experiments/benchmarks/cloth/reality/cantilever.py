"""Peirce's cantilever (ASTM D1388, BS 3356): what bending length has a strip that hangs over an edge?

The strip lies over a bar in its middle and both ends hang: by symmetry it leaves the bar level, as from a clamp. (A
clamped row of particles would not do: a mesh's bend is spread half an edge to both sides of the row it is at, so the
clamp would reach half an edge less far.)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from experiments.benchmarks.cloth.reality.bench import RESTLESS, Cloth, elastic, fabric_named
from experiments.benchmarks.cloth.reality.elastica import bending_length_of, cantilever, peirce_cantilever
from experiments.benchmarks.cloth.reality.rows import Row, millimetres
from experiments.benchmarks.cloth.reality.sheets import lifted, strip, turned
from polyfold.garments import Fabric

WIDTH = 0.025
"""Of the strip [m], as the standards have it."""
WIDE = 0.1
"""Of a wider strip [m]."""
REST = 6.0
"""Time that a strip gets to come to rest [s]."""
COARSEST = 3.0
"""An overhang has at least so many edges."""
BAR = 0.08
"""Height of the bar [m]: nothing touches the table, and single precision is at its finest near it."""
BENDING_LENGTHS = (0.008, 0.012, 0.017, 0.025)
"""Asked of the solver [m]; 5 % of 251 fabrics are below 11 mm and 5 % above 29 (doi 10.1145/3550454.3555464)."""


@dataclass(frozen=True)
class Hanging:
    """What a strip does over the bar, mean of its two ends.

    Attributes:
        overhang: of each end [m].
        angle: of the line from bar to tip below the horizontal [rad].
        drop: of the tip [m].
        speed: of the particles at the end, RMS [m/s].
    """

    overhang: float
    angle: float
    drop: float
    speed: float

    @property
    def bending_length(self) -> float:
        """By the elastica [m]."""
        return bending_length_of(self.angle, self.overhang)


def overhang_for(bending_length: float, edge_length: float) -> float:
    """Twice the bending length, where the tip hangs at 41.5°, or what the mesh can show [m]."""
    return max(2 * bending_length, COARSEST * edge_length)


@lru_cache
def hang(fabric: Fabric, overhang: float, edge_length: float, along: str = "weft", width: float = WIDTH) -> Hanging:
    """Lay a strip over the bar, cut along the weft (x) or the warp (y), and let it come to rest."""
    mesh = strip(2 * overhang, width, edge_length, (0.0,))
    distance = mesh.vertices[:, 0].copy()
    if along == "warp":
        mesh = turned(mesh)
    cloth = Cloth(mesh, fabric, lifted(mesh.vertices, BAR))
    cloth.pin(np.flatnonzero(np.abs(distance) < 1e-3 * edge_length))
    tips = np.abs(distance) > overhang - 1e-3 * edge_length
    speed = cloth.rest(REST)
    now = cloth.positions()[tips]
    reach, drop = np.abs(now[:, 1 if along == "warp" else 0]).mean(), BAR - now[:, 2].mean()
    return Hanging(overhang, float(np.arctan2(drop, reach)), float(drop), speed)


def cantilever_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Bending length in and out, for the fabric along warp and weft and for the range that fabrics have."""
    fabric = elastic(fabric)
    asked = [("warp", fabric, fabric.bending_length_warp), ("weft", fabric, fabric.bending_length_weft)]
    some = replace(fabric_named("poplin"), name="any")
    asked += [("warp", elastic(some, value), value) for value in BENDING_LENGTHS]
    for along, sample, length in asked:
        yield _row(sample, along, length, hang(sample, overhang_for(length, edge_length), edge_length, along))
    length = fabric.bending_length_weft
    yield _row(fabric, f"weft, {millimetres(WIDE, 0)} wide", length, _hang_wide(fabric, length, edge_length))


def _hang_wide(fabric: Fabric, length: float, edge_length: float) -> Hanging:
    """A strip so wide that its edges, where a mesh bends more easily, count for little."""
    return hang(fabric, overhang_for(length, edge_length), edge_length, width=WIDE)


def _row(fabric: Fabric, along: str, asked: float, result: Hanging) -> Row:
    exact = cantilever(result.overhang, asked)
    peirce = peirce_cantilever(result.angle, result.overhang) if result.angle > 0 else float("nan")
    error = result.bending_length / asked - 1.0
    ours = (
        f"{millimetres(result.bending_length)} ({100 * error:+.1f} %; Peirce's formula {millimetres(peirce)}), "
        f"tip at {np.degrees(result.angle):.1f}°, {millimetres(result.drop)} down"
    )
    if result.speed > RESTLESS:
        ours = f"never at rest ({1000 * result.speed:.0f} mm/s)"
    true_angle = np.degrees(np.arctan2(-exact.up[-1], exact.across[-1]))
    return Row(
        "cantilever",
        fabric.name,
        f"bending length along the {along}, overhang {millimetres(result.overhang, 0)}",
        f"{millimetres(asked)} asked for, tip at {true_angle:.1f}°, {millimetres(-exact.up[-1])} down (elastica)",
        ours,
        "2 ends",
    )
