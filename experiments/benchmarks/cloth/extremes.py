"""Folds far outside of what anyone would plan: ``python -m experiments.benchmarks.cloth.extremes``.

Cloth is taken anywhere, by one arm or two, and carried to the corners and borders of the picture, together or apart.
What is wanted is not a good fold but an end to it: soon, with cloth that is not stretched beyond what cloth can bear,
and that lies on the table. Prints a Markdown table, and the worst of them with what repeats them.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import cloth_mask
from experiments.benchmarks.cloth.measures import strain
from polyfold import plugins
from polyfold.errors import SimulationError
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
        strain: largest absolute change of an edge's length.
        height: of the highest particle at rest [m].
        diverged: whether it was refused for that.
    """

    kind: str
    seed: int
    action: Action
    seconds: float
    strain: float
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
    for what in ("seconds", "strain", "height"):
        print(f"\nWorst by {what}:")
        for fold in sorted(folds, key=lambda fold: -getattr(fold, what))[: options.worst]:
            picks, places = fold.action.picks.round().tolist(), fold.action.places.round().tolist()
            told = f"{fold.seconds:.1f} s, strain {fold.strain:.0%}, {1000 * fold.height:.0f} mm high"
            print(f"  {fold.kind} {fold.seed}: {picks} to {places}: {told}")


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
            clock, diverged = time.process_time(), False
            try:
                picture = simulator.execute(action)
            except SimulationError:
                diverged = True
            seconds, state = time.process_time() - clock, simulator.state()
            stretched = float(np.abs(strain(garment.mesh, state.positions)).max())
            yield Extreme(kind, at, action, seconds, stretched, float(state.positions[:, 2].max()), diverged)


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
    strains = np.array([fold.strain for fold in folds])
    heights = np.array([fold.height for fold in folds])
    median = float(np.median(seconds))
    rows = [
        ("diverged, and undone", str(sum(fold.diverged for fold in folds))),
        ("CPU time, median", f"{median:.2f} s"),
        ("CPU time, p99 and largest", f"{np.percentile(seconds, 99) / median:.1f}, {seconds.max() / median:.1f} times"),
        ("longer than 5 times the median", str(int((seconds > 5 * median).sum()))),
        ("largest strain of an edge: median, p99, largest", ", ".join(
            f"{100 * value:.0f} %" for value in (np.median(strains), np.percentile(strains, 99), strains.max()))),
        ("folds with an edge strained by over 25 %", str(int((strains > 0.25).sum()))),
        ("height at rest: p99, largest", f"{1000 * np.percentile(heights, 99):.0f}, {1000 * heights.max():.0f} mm"),
        ("folds that end above 300 mm", str(int((heights > 0.3).sum()))),
    ]  # fmt: skip
    n = len(folds)
    return ["| figure | value | n |", "|---|---|---|", *(f"| {what} | {value} | {n} |" for what, value in rows)]


if __name__ == "__main__":
    main()
