"""Layers that pierce each other, with guarantee and without, by ipctk (Incremental Potential Contact) and by us."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import SCRIPTS, Trial, cloth_mask, random_action
from experiments.benchmarks.cloth.measures import crossing_edges
from experiments.benchmarks.cloth.reality.bench import garment, simulator
from experiments.benchmarks.cloth.reality.rows import Row, percent
from polyfold.errors import SimulationError
from polyfold.garments import Fabric, Garment, Mesh

KINDS = ("square", "tshirt")
FOLDS, SEEDS = 4, range(2000, 2005)
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
    """Piercing edges after random folds of squares and t-shirts and halvings of trousers, guaranteed not to or not."""
    ways: list[tuple[str, str, Callable[[Any, Garment, int], None]]] = [
        (f"{FOLDS} random folds, {kind}", kind, _fold_at_random) for kind in KINDS
    ]
    ways.append(("two halvings, trousers", HALVED.kind, _halve))
    for name, kind, fold in ways:
        without = None
        for guaranteed in (False, True):
            measured = [_measured(fold, kind, seed, edge_length, fabric, guaranteed) for seed in SEEDS]
            theirs, ours, seconds = zip(*measured, strict=True)
            cost = f"; {sum(seconds) / without:.1f} times the CPU time" if without else ""
            without = sum(seconds)
            yield Row(
                "penetration",
                fabric.name,
                f"edges that pierce a triangle after {name}" + (", `guaranteed`" if guaranteed else ""),
                "0 % (cloth)",
                f"{_by_ipctk(theirs)} (ipctk), {percent(float(np.mean(ours)), 2)} (our count){cost}",
                f"{len(SEEDS)} garments",
            )


def _measured(
    fold: Callable[[Any, Garment, int], None],
    kind: str,
    seed: int,
    edge_length: float,
    fabric: Fabric,
    guaranteed: bool,
) -> tuple[float | None, float, float]:
    """Share of piercing edges by ipctk and by our count, and CPU seconds."""
    world, sample = simulator(guaranteed=guaranteed), garment(kind, seed, edge_length, fabric)
    world.reset(sample, seed)  # the first one in a process compiles
    begin = process_time()
    fold(world, sample, seed)
    seconds, positions = process_time() - begin, world.state().positions
    return _share(sample.mesh, positions), crossing_edges(sample.mesh, positions), seconds


def _fold_at_random(world: Any, sample: Garment, seed: int) -> None:
    rng = np.random.default_rng(seed)
    picture = world.reset(sample, seed)
    for _ in range(FOLDS):
        try:
            picture = world.execute(random_action(cloth_mask(picture), rng)[0])
        except SimulationError:
            continue  # the state before the fold is restored; the next fold is another one


def _halve(world: Any, sample: Garment, seed: int) -> None:
    """Fold trousers in half, and in half again."""
    world.reset(sample, seed)
    trial = Trial(HALVED, world.state())
    for fold in HALVED.folds:
        world.execute(trial.act(fold, world.state()))


def _by_ipctk(shares: tuple[float | None, ...]) -> str:
    known = [share for share in shares if share is not None]
    if len(known) < len(shares):
        return "install it: pip install ipctk"
    return f"{percent(float(np.mean(known)), 2)}, at most {percent(max(known), 2)}"


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
