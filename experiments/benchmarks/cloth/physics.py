"""How well and how fast the ``xpbd`` simulator folds cloth: ``python -m experiments.benchmarks.cloth.physics``.

Prints a Markdown table. Times are processor seconds of this process, so that a busy machine does not disturb them.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from experiments.benchmarks.cloth.folding import SCRIPTS, Script, Trial, cloth_mask, random_action, sized
from experiments.benchmarks.cloth.measures import crossing_edges, layer_order, strain
from polyfold import plugins
from polyfold.errors import SimulationError
from polyfold.geometry import iou

KINDS = ("square", "rectangle", "tshirt", "pants")
DATA_EDGE, EVALUATION_EDGE = 0.0155, 0.0125
"""Edge lengths [m] for random folds and for scripted ones."""
LANDED = 0.030
"""A flap has landed if its particles are within this of their mirror images on average [m]."""

Row = tuple[str, str, str]


@dataclass
class RandomFolds:
    """What random folds gave."""

    seconds: list[float] = field(default_factory=list)
    strains: list[Any] = field(default_factory=list)
    orders: list[float] = field(default_factory=list)
    drifts: list[float] = field(default_factory=list)
    refolds: int = 0
    diverged: int = 0


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the measurements that were asked for."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.physics", description=__doc__)
    parser.add_argument("--folds", type=int, default=1000, help="random folds over all kinds (default 1000)")
    parser.add_argument("--timed", type=int, default=60, help="random folds of a 2,000-particle t-shirt (default 60)")
    parser.add_argument("--garments", type=int, default=10, help="garments per scripted sequence (default 10)")
    parser.add_argument("--scaling", action="store_true", help="also measure the time from 1,000 to 8,000 particles")
    parser.add_argument("--seed", type=int, default=2000, help="first garment seed (default 2000)")
    parser.add_argument("--guaranteed", action="store_true", help="random folds in which no ply may pass another")
    options = parser.parse_args(arguments)
    rows: list[Row] = []
    if options.folds:
        rows += _random_rows(options.folds, options.seed, options.guaranteed)
    if options.timed:
        rows += _timing_rows(options.timed, options.seed)
    if options.garments:
        rows += _script_rows(options.garments, options.seed)
    rows += _determinism_rows(options.seed)
    if options.scaling:
        rows += _scaling_rows(options.seed)
    print("| figure | value | n |\n|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


def _progress(items: Iterable[Any], total: int, label: str) -> Iterator[Any]:
    from tqdm import tqdm

    return iter(tqdm(items, total=total, desc=label, file=sys.stderr, mininterval=2.0))


def _random_rows(folds: int, seed: int, guaranteed: bool) -> list[Row]:
    result = RandomFolds()
    for _ in _progress(_random_folds(result, folds, seed, guaranteed), folds, "random folds"):
        pass
    strains = np.abs(np.concatenate(result.strains))
    orders = np.array([order for order in result.orders if np.isfinite(order)])
    drifts = np.array(result.drifts)
    n = str(folds)
    return [
        ("random folds that diverged", str(result.diverged), n),
        ("of them on folded cloth", str(result.refolds), n),
        ("edge strain, p99 of absolute value", f"{100 * np.percentile(strains, 99):.1f} %", f"{len(strains)} edges"),
        ("edge strain, largest", f"{100 * strains.max():.0f} %", f"{len(strains)} edges"),
        ("layer order right, of landed folds", f"{100 * orders.mean():.2f} %", f"{len(orders)} folds"),
        ("drift in one more second, p99", f"{1000 * np.percentile(drifts, 99):.1f} mm", n),
        ("drift of at most 5 mm", f"{100 * (drifts <= 0.005).mean():.1f} %", n),
        ("CPU time per random fold, mean", f"{np.mean(result.seconds):.2f} s", n),
    ]


def _random_folds(result: RandomFolds, folds: int, seed: int, guaranteed: bool) -> Iterator[None]:
    """Fold garments of all kinds one to three times each, filling ``result``."""
    simulator = plugins.create("simulators", "xpbd", {"guaranteed": guaranteed})
    done = 0
    while done < folds:
        garment = plugins.generate_garment(KINDS[seed % 4], seed, DATA_EDGE)
        picture, rng = simulator.reset(garment, seed), np.random.default_rng(seed)
        for repeat in range(min(1 + (seed // 4) % 3, folds - done)):
            action, line = random_action(cloth_mask(picture), rng)
            before = simulator.state()
            started = time.process_time()
            try:
                picture = simulator.execute(action)
            except SimulationError:
                result.diverged += 1
            result.seconds.append(time.process_time() - started)
            after = simulator.state()
            result.strains.append(strain(garment.mesh, after.positions))
            result.orders.append(_order_if_landed(before, after, line))
            simulator.wait(1.0)
            result.drifts.append(float(np.linalg.norm(simulator.state().positions - after.positions, axis=1).mean()))
            simulator.restore(after)
            result.refolds += repeat > 0
            done += 1
            yield
        seed += 1


def _order_if_landed(before: Any, after: Any, line: Any) -> float:
    scale = before.camera.pixels_per_metre
    pixels = before.camera.to_pixels(before.positions)
    lifted = line.lifts(pixels)
    error = np.hypot(*(after.camera.to_pixels(after.positions) - line.mirror(pixels)).T) / scale
    if not lifted.any() or error[lifted].mean() > LANDED:
        return float("nan")
    far = line.distance(pixels) > 2 * DATA_EDGE * scale
    return layer_order(after.positions, lifted, far, 0.5 * DATA_EDGE)


def _timing_rows(folds: int, seed: int) -> list[Row]:
    simulator = plugins.create("simulators", "xpbd")
    seconds, pictures = [], []
    picture, rng = None, np.random.default_rng(seed)
    for index in _progress(range(folds), folds, "2,000 particles"):
        if picture is None or index % 3 == 0:
            garment = sized("tshirt", seed + index, 2000)
            picture, rng = simulator.reset(garment, seed + index), np.random.default_rng(seed + index)
        action, _ = random_action(cloth_mask(picture), rng)
        started = time.process_time()
        picture = simulator.execute(action)
        seconds.append(time.process_time() - started)
        started = time.process_time()
        simulator.observe()
        pictures.append(time.process_time() - started)
    # The first folds load the compiled loop from its cache.
    return [
        ("CPU time per random fold of a 2,000-particle t-shirt, mean", f"{np.mean(seconds[3:]):.3f} s", str(folds - 3)),
        ("the same, largest", f"{np.max(seconds[3:]):.2f} s", str(folds - 3)),
        ("CPU time per picture", f"{1000 * np.median(pictures):.0f} ms", str(folds)),
    ]


def _script_rows(garments: int, seed: int) -> list[Row]:
    rows: list[Row] = []
    overlaps, errors = [], []
    for script in SCRIPTS:
        runs = [_run(script, seed + k) for k in _progress(range(garments), garments, script.name)]
        overlap, flap, rest, crossing = np.array(runs).T
        overlaps.append(overlap)
        errors.append(flap)
        rows += [
            (f"{script.name}: overlap with the ideal (IoU), mean", f"{overlap.mean():.3f}", str(garments)),
            (f"{script.name}: overlap, worst", f"{overlap.min():.3f}", str(garments)),
            (f"{script.name}: error of moved particles, mean", f"{1000 * flap.mean():.1f} mm", str(garments)),
            (f"{script.name}: displacement of the rest, mean", f"{1000 * rest.mean():.1f} mm", str(garments)),
            (f"{script.name}: crossing edges, mean", f"{100 * crossing.mean():.2f} %", str(garments)),
        ]
    total = str(garments * len(SCRIPTS))
    rows.append(("all sequences: overlap, mean", f"{np.mean(overlaps):.3f}", total))
    rows.append(("all sequences: error of moved particles, mean", f"{1000 * np.mean(errors):.1f} mm", total))
    return rows


def _run(script: Script, seed: int) -> tuple[float, float, float, float]:
    """Overlap, error of moved and of other particles [m] and share of crossing edges after a scripted sequence."""
    simulator = plugins.create("simulators", "xpbd")
    garment = plugins.generate_garment(script.kind, seed, EVALUATION_EDGE)
    picture = simulator.reset(garment, seed)
    trial = Trial(script, simulator.state())
    for fold in script.folds:
        picture = simulator.execute(trial.act(fold, simulator.state()))
    state = simulator.state()
    overlap = iou(cloth_mask(picture), trial.ideal_mask(garment.mesh.triangles))
    return overlap, *trial.flap_error(state), crossing_edges(garment.mesh, state.positions)


def _determinism_rows(seed: int) -> list[Row]:
    def final_bytes(script: Script) -> bytes:
        simulator = plugins.create("simulators", "xpbd")
        garment = plugins.generate_garment(script.kind, seed, DATA_EDGE)
        picture = simulator.reset(garment, seed)
        trial = Trial(script, simulator.state())
        for fold in script.folds:
            picture = simulator.execute(trial.act(fold, simulator.state()))
        return simulator.state().positions.tobytes() + picture.rgb.tobytes() + picture.depth.tobytes()

    same = sum(final_bytes(script) == final_bytes(script) for script in SCRIPTS)
    return [("same seed twice, same bytes", f"{same} of {len(SCRIPTS)}", f"{len(SCRIPTS)} sequences")]


def _scaling_rows(seed: int) -> list[Row]:
    """CPU time of the t-shirt's sequence by number of particles, each mesh with the time step it needs."""
    simulator = plugins.create("simulators", "xpbd")
    block, garments = SCRIPTS[0], 3
    counts, times = [], []
    sizes = (1000, 2000, 4000, 8000)
    for size in _progress(sizes, len(sizes), "scaling"):
        seconds, particles = [], []
        for k in range(garments):
            garment = sized("tshirt", seed + k, size)
            simulator.reset(garment, seed + k)
            trial = Trial(block, simulator.state())
            for fold in block.folds:
                action = trial.act(fold, simulator.state())
                started = time.process_time()
                simulator.execute(action)
                seconds.append(time.process_time() - started)
            particles.append(len(garment.mesh.vertices))
        counts.append(np.mean(particles))
        times.append(np.mean(seconds))
    exponent = np.polyfit(np.log(counts), np.log(times), 1)[0]
    folds = str(garments * len(block.folds))
    rows = [(f"CPU time per fold, {c:.0f} particles", f"{t:.2f} s", folds) for c, t in zip(counts, times, strict=True)]
    return [*rows, ("growth of time with particles, exponent", f"{exponent:.2f}", folds)]


if __name__ == "__main__":
    main()
