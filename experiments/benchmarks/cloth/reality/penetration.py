"""Layers that pierce each other after four random folds, counted by ipctk (Incremental Potential Contact) and by us."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import SCRIPTS, Trial, cloth_mask, random_action
from experiments.benchmarks.cloth.measures import crossing_edges
from experiments.benchmarks.cloth.reality.bench import garment, simulator
from experiments.benchmarks.cloth.reality.rows import Row, percent
from polyfold.errors import SimulationError
from polyfold.garments import Fabric, Mesh

Floats = NDArray[np.float64]

KINDS = ("square", "tshirt")
FOLDS, GARMENTS, FIRST_SEED = 4, 5, 2000
HALVED = next(script for script in SCRIPTS if script.kind == "pants")


def ipctk_crossings(mesh: Mesh, positions: NDArray[np.float64]) -> float:
    """Share of the mesh's edges that pierce a triangle at positions [m], shape (N, 3), by exact predicates.

    Raises:
        ImportError: without the package ``ipctk``.
    """
    ipctk: Any = _ipctk()
    faces = np.asfortranarray(mesh.triangles, np.int32)
    edges = np.asfortranarray(ipctk.edges(faces), np.int32)
    points = np.asfortranarray(positions, float)
    if not ipctk.has_intersections(ipctk.CollisionMesh(points, edges, faces), points):
        return 0.0
    near = ipctk.HashGrid()
    near.build(points, edges, faces)
    pierced = set()
    for pair in near.detect_edge_face_candidates():
        ends, corners = edges[pair.edge_id], faces[pair.face_id]
        apart = not set(ends.tolist()) & set(corners.tolist())
        if apart and ipctk.is_edge_intersecting_triangle(*points[ends], *points[corners]):
            pierced.add(pair.edge_id)
    return len(pierced) / len(edges)


def penetration_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """Piercing edges after random folds of squares and t-shirts."""
    ways: list[tuple[str, Callable[[int], tuple[Mesh, Floats]]]] = [
        (f"{FOLDS} random folds, {kind}", lambda seed, kind=kind: _randomly_folded(kind, seed, edge_length, fabric))
        for kind in KINDS
    ]
    ways.append(("two halvings, trousers", lambda seed: _halved(seed, edge_length, fabric)))
    for name, fold in ways:
        theirs, ours = [], []
        for seed in range(FIRST_SEED, FIRST_SEED + GARMENTS):
            mesh, positions = fold(seed)
            theirs.append(_share(mesh, positions))
            ours.append(crossing_edges(mesh, positions))
        by_ipctk = (
            "install it: pip install ipctk"
            if None in theirs
            else f"{percent(float(np.mean(theirs)), 2)}, at most {percent(float(np.max(theirs)), 2)}"
        )
        yield Row(
            "penetration",
            fabric.name,
            f"edges that pierce a triangle after {name}",
            "0 % (cloth)",
            f"{by_ipctk} (ipctk), {percent(float(np.mean(ours)), 2)} (our count)",
            f"{GARMENTS} garments",
        )


def _randomly_folded(kind: str, seed: int, edge_length: float, fabric: Fabric) -> tuple[Mesh, NDArray[np.float64]]:
    world, rng = simulator(), np.random.default_rng(seed)
    sample = garment(kind, seed, edge_length, fabric)
    picture = world.reset(sample, seed)
    for _ in range(FOLDS):
        try:
            picture = world.execute(random_action(cloth_mask(picture), rng)[0])
        except SimulationError:
            continue  # the state before the fold is restored; the next fold is another one
    return sample.mesh, world.state().positions


def _halved(seed: int, edge_length: float, fabric: Fabric) -> tuple[Mesh, Floats]:
    """Trousers folded in half, and in half again."""
    world, sample = simulator(), garment(HALVED.kind, seed, edge_length, fabric)
    world.reset(sample, seed)
    trial = Trial(HALVED, world.state())
    for fold in HALVED.folds:
        world.execute(trial.act(fold, world.state()))
    return sample.mesh, world.state().positions


def _share(mesh: Mesh, positions: NDArray[np.float64]) -> float | None:
    try:
        return ipctk_crossings(mesh, positions)
    except ImportError:
        return None


def _ipctk() -> Any:
    try:
        import ipctk  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise ImportError("counting by ipctk needs that package; run: pip install ipctk") from error
    return ipctk
