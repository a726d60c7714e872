"""A strip folded in half: how far apart do its two ends lie, by the path that the gripper took?

Petrík, Smutný, Kyrki, Static stability of robotic fabric strip folding, doi 10.1109/TMECH.2020.2980957 (arXiv
1902.11021), and Petrík, Kyrki, Feedback-based fabric strip folding, arXiv 1904.01298, fold strips along three paths:
the triangle of van den Berg et al. (cloth without stiffness: the lifted part hangs straight), the circle (a rigid
lifted part) and a path or a controller that knows the strip's stiffness.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import Cloth, simulator
from experiments.benchmarks.cloth.reality.rows import Row, millimetres
from experiments.benchmarks.cloth.reality.sheets import lifted, strip
from polyfold.garments import Fabric, Garment, Mesh
from polyfold.types import Action

Floats = NDArray[np.float64]

LENGTH, WIDTH = 0.30, 0.05
"""Of the strip [m]."""
SPEED = 0.2
"""Of the gripper on the published paths [m/s]."""
CORNERS = ("bottom_left", "bottom_right", "top_right", "top_left")
PUBLISHED = (
    "no figure could be read (abstracts of doi 10.1109/TMECH.2020.2980957 and arXiv 1904.01298: paths that ignore "
    "stiffness misplace the end, feedback is best); 0 mm is right"
)


@dataclass(frozen=True)
class Folded:
    """A strip after its fold, along its length, mean over its width.

    Attributes:
        misalignment: how far the carried end lies beyond the other one [m]; negative if it falls short.
        slip: how far the other end was moved towards the crease [m].
    """

    misalignment: float
    slip: float


def fold_along(fabric: Fabric, edge_length: float, path: str) -> Folded:
    """Carry one end of a strip, held along its edge and free to turn, onto the other one.

    Args:
        fabric: of the strip.
        edge_length: of the mesh [m].
        path: ``triangle`` or ``circle``.
    """
    mesh = strip(LENGTH, WIDTH, edge_length)
    start = lifted(mesh.vertices, fabric.thickness / 2)
    moving, resting = _ends(mesh.vertices)
    cloth = Cloth(mesh, fabric, start)
    cloth.wait(0.3)
    before = cloth.positions()
    cloth.pin(moving)
    target = fabric.thickness * 1.5
    cloth.carry(before[moving] + _path(path, target - float(before[moving, 2].mean()), cloth.substep)[:, None])
    cloth.wait(0.1)
    cloth.pin(np.zeros(0, np.int64))
    cloth.wait(2.0)
    return _compare(before, cloth.positions(), moving, resting)


def fold_in_simulator(fabric: Fabric, edge_length: float) -> Folded:
    """Let the simulator fold the strip: two grippers at the corners of one end, along its own arc."""
    mesh = strip(LENGTH, WIDTH, edge_length)
    moving, resting = _ends(mesh.vertices)
    corners: dict[str, int] = dict(zip(CORNERS, _corners(mesh), strict=True))
    world = simulator()
    world.reset(Garment("rectangle", "strip", None, mesh, corners, fabric=fabric), 0)
    before = world.state()
    pixels = before.camera.to_pixels(before.positions)
    order = [CORNERS.index(name) for name in ("bottom_left", "top_left", "bottom_right", "top_right")]
    picks_and_places = pixels[[_corners(mesh)[k] for k in order]]
    world.execute(Action(picks_and_places[:2], picks_and_places[2:]))
    return _compare(before.positions, world.state().positions, moving, resting)


def strip_fold_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Misalignment by path."""
    ways = {
        "the simulator's arc": fold_in_simulator(fabric, edge_length),
        "triangle": fold_along(fabric, edge_length, "triangle"),
        "circle": fold_along(fabric, edge_length, "circle"),
    }
    for name, result in ways.items():
        ours = f"{millimetres(result.misalignment)} (the lying end slipped {millimetres(result.slip)})"
        quantity = f"end beyond the other, {name}, strip {millimetres(LENGTH, 0)}"
        yield Row("strip fold", fabric.name, quantity, PUBLISHED, ours, "1")


def _path(name: str, rise: float, substep: float) -> Floats:
    """Offsets from the start [m] after every substep, shape (S, 3), ending higher by ``rise`` [m]."""
    along = np.linspace(0.0, 1.0, round(np.pi / 2 * LENGTH / SPEED / substep))
    eased = along**2 * (3.0 - 2.0 * along)
    if name == "circle":
        across, up = (1.0 - np.cos(np.pi * eased)) / 2, np.sin(np.pi * eased) / 2
    else:
        across, up = eased, 0.5 - np.abs(eased - 0.5)
    return np.column_stack([LENGTH * across, 0 * across, LENGTH * up + rise * eased])


def _ends(flat: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Particles of the end that is carried and of the other one."""
    return np.flatnonzero(flat[:, 0] < -LENGTH / 2 + 1e-6), np.flatnonzero(flat[:, 0] > LENGTH / 2 - 1e-6)


def _corners(mesh: Mesh) -> list[int]:
    """Vertices at the corners, counter-clockwise from the lower left."""
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    places = signs * np.array([LENGTH, WIDTH]) / 2
    return [int(np.hypot(*(mesh.vertices - place).T).argmin()) for place in places]


def _compare(before: Floats, after: Floats, moving: NDArray[np.int64], resting: NDArray[np.int64]) -> Folded:
    start, end = before[moving, :2].mean(0), before[resting, :2].mean(0)
    along = (end - start) / np.hypot(*(end - start))
    carried, other = after[moving, :2].mean(0), after[resting, :2].mean(0)
    return Folded(float((carried - other) @ along), float((end - other) @ along))
