"""Folds far outside of what anyone would plan: ``python -m experiments.benchmarks.cloth.extremes``.

Cloth is taken anywhere, by one arm or two, and carried to the corners and borders of the picture, together or apart.
What is wanted is not a good fold but an end to it: soon, with cloth that is not stretched beyond what cloth can bear,
and that lies on the table. Prints a Markdown table, and the worst of them with what repeats them.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import cloth_mask
from experiments.benchmarks.cloth.measures import strain
from polyfold import plugins
from polyfold.errors import SimulationError
from polyfold.garments import Mesh
from polyfold.types import Action

KINDS = ("square", "rectangle", "tshirt", "pants")
EDGE = 0.0155
"""Edge length [m], as for collected data."""


@dataclass(frozen=True)
class Extreme:
    """What one fold came to.

    Attributes:
        kind, seed: the garment.
        action: picks and places.
        seconds: processor time.
        stretch: largest strain of an edge at rest, and at any time, looked at 10 times a second.
        pressed: largest compression of an edge at rest: crumpled cloth has folds smaller than its mesh.
        short: how far an arm stopped from its place because the cloth reached no farther [m].
        height: of the highest particle at rest [m].
        diverged: whether it was refused for that.
    """

    kind: str
    seed: int
    action: Action
    seconds: float
    stretch: tuple[float, float]
    pressed: float
    short: float
    height: float
    diverged: bool


def main(arguments: Sequence[str] | None = None) -> None:
    """Fold, and print the table and the worst."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.extremes", description=__doc__)
    parser.add_argument("--folds", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=5000, help="first garment seed (default 5000)")
    parser.add_argument("--worst", type=int, default=5, help="how many of the worst are listed (default 5)")
    options = parser.parse_args(arguments)
    from tqdm import tqdm

    made = extreme_folds(options.folds, options.seed)
    folds = list(tqdm(made, total=options.folds, file=sys.stderr, mininterval=2.0))
    print("\n".join(table(folds)))
    for what in ("seconds", "stretch", "height"):
        print(f"\nWorst by {what}:")
        for fold in sorted(folds, key=lambda fold: getattr(fold, what), reverse=True)[: options.worst]:
            picks, places = fold.action.picks.round().tolist(), fold.action.places.round().tolist()
            rest, ever = fold.stretch
            told = f"{fold.seconds:.1f} s, stretched by {rest:.0%}, {ever:.0%} on the way"
            print(f"  {fold.kind} {fold.seed}: {picks} to {places}: {told}, {1000 * fold.height:.0f} mm high")


def extreme_folds(count: int, seed: int) -> Iterator[Extreme]:
    """So many folds, two in a row on each garment."""
    simulator = plugins.create("simulators", "xpbd")
    for first in range(0, count, 2):
        at = seed + first // 2
        kind, rng = KINDS[at % 4], np.random.default_rng(at)
        garment = plugins.generate_garment(kind, at, EDGE)
        picture = simulator.reset(garment, at)
        for _ in range(min(2, count - first)):
            action = _extreme_action(cloth_mask(picture), rng)
            before, clock = simulator.state(), time.process_time()
            try:
                picture = simulator.execute(action)
            except SimulationError:
                yield Extreme(kind, at, action, time.process_time() - clock, (0.0, 0.0), 0.0, 0.0, 0.0, True)
                continue
            seconds, state = time.process_time() - clock, simulator.state()
            simulator.restore(before)
            ever = _most_on_the_way(simulator, garment.mesh, action)
            simulator.restore(state)
            at_rest = strain(garment.mesh, state.positions)
            stretch = float(at_rest.max()), max(ever, float(at_rest.max()))
            short, height = max(state.short or (0.0,)), float(state.positions[:, 2].max())
            yield Extreme(kind, at, action, seconds, stretch, float(-at_rest.min()), short, height, False)


def _most_on_the_way(simulator: Any, mesh: Mesh, action: Action) -> float:
    """The largest strain while a fold is made once more, which is made as before."""
    found: list[float] = []
    simulator.record(lambda _: found.append(float(strain(mesh, simulator.state().positions).max())), 10.0)
    try:
        simulator.execute(action)
    finally:
        simulator.record(None)
    return max(found)


def _extreme_action(mask: NDArray[np.bool_], rng: np.random.Generator) -> Action:
    """Picks anywhere on the cloth; places in corners, on borders, together in one point, or anywhere at all."""
    height, width = mask.shape
    arms = int(rng.integers(1, 3))
    rows, columns = np.nonzero(mask)
    chosen = rng.choice(len(rows), arms)
    picks = np.column_stack([columns[chosen], rows[chosen]]).astype(float)
    low, high = np.array([4.0, 4.0]), np.array([width - 5.0, height - 5.0])
    anywhere = rng.uniform(low, high, (arms, 2))
    how = rng.choice(["corners", "borders", "together", "anywhere"])
    if how == "corners":
        places = np.where(rng.random((arms, 2)) < 0.5, low, high)
    elif how == "borders":
        places = anywhere.copy()
        for place in places:
            axis = rng.integers(2)
            place[axis] = rng.choice([low[axis], high[axis]])
    elif how == "together":
        places = anywhere[0] + rng.uniform(-6, 6, (arms, 2))
    else:
        places = anywhere
    return Action(picks, np.clip(places, low, high))


def table(folds: Sequence[Extreme]) -> list[str]:
    """The figures as lines of a Markdown table."""
    seconds = np.array([fold.seconds for fold in folds])
    rest, ever = np.array([fold.stretch for fold in folds]).T
    pressed = np.array([fold.pressed for fold in folds])
    heights = np.array([fold.height for fold in folds])
    median = float(np.median(seconds))
    rows = [
        ("diverged, and undone", str(sum(fold.diverged for fold in folds))),
        ("CPU time, median", f"{median:.2f} s"),
        ("CPU time, p99 and largest", f"{np.percentile(seconds, 99) / median:.1f}, {seconds.max() / median:.1f} times"),
        ("longer than 5 times the median", str(int((seconds > 5 * median).sum()))),
        ("... than 5 times the median of its kind", str(_long_for_their_kind(folds))),
        ("arms that gave way by more than 5 mm", str(sum(fold.short > 0.005 for fold in folds))),
        ("largest stretch of an edge at rest: median, p99, largest", _three(rest)),
        ("folds with an edge stretched by over 25 % at rest", str(int((rest > 0.25).sum()))),
        ("largest stretch of an edge on the way: median, p99, largest", _three(ever)),
        ("folds with an edge stretched by over 25 % on the way", str(int((ever > 0.25).sum()))),
        ("largest compression of an edge at rest: median, p99, largest", _three(pressed)),
        ("height at rest: p99, largest", f"{1000 * np.percentile(heights, 99):.0f}, {1000 * heights.max():.0f} mm"),
        ("folds that end above 300 mm", str(int((heights > 0.3).sum()))),
    ]
    n = len(folds)
    return ["| figure | value | n |", "|---|---|---|", *(f"| {what} | {value} | {n} |" for what, value in rows)]


def _long_for_their_kind(folds: Sequence[Extreme]) -> int:
    """How many took longer than five times the median of their kind: t-shirts have two plies and many particles."""
    usual = {kind: statistics.median(fold.seconds for fold in folds if fold.kind == kind) for kind in KINDS}
    return sum(fold.seconds > 5 * usual[fold.kind] for fold in folds)


def _three(shares: NDArray[np.float64]) -> str:
    return ", ".join(f"{100 * value:.0f} %" for value in (np.median(shares), np.percentile(shares, 99), shares.max()))


if __name__ == "__main__":
    main()
