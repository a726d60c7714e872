"""Folds far outside of what anyone would plan: ``python -m experiments.benchmarks.cloth.extremes``.

Cloth is taken anywhere, by one arm or two, and carried to the corners and borders of the picture, together or apart.
What is wanted is not a good fold but an end to it: soon, with cloth that is not stretched beyond what cloth can bear,
and that lies on the table. Prints a Markdown table, and the worst of them with what repeats them. Can be killed and
resumed; after a change to the simulator, name another ``--out``.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import cloth_mask
from experiments.benchmarks.cloth.measures import strain
from polyfold import plugins
from polyfold.errors import SimulationError
from polyfold.logs import JsonLines
from polyfold.studies import in_processes
from polyfold.types import Action

KINDS = ("square", "rectangle", "tshirt", "pants")
EDGE = 0.0155
"""Edge length [m], as for collected data."""
LOOKS = 10.0
"""How often the cloth is looked at on the way [1/s of simulated time]."""


@dataclass(frozen=True)
class Extreme:
    """What one fold came to.

    Attributes:
        kind, seed: the garment.
        picks, places: the action [px].
        seconds: processor time, with a picture :data:`LOOKS` times a second.
        rest, ever: largest strain of an edge at rest, and whenever it was looked at.
        pressed: largest compression of an edge at rest: crumpled cloth has folds smaller than its mesh.
        short: how far an arm stopped from its place because the cloth reached no farther [m].
        slipped: the largest share of what an arm held that slipped out of its grip.
        height: of the highest particle at rest [m].
        diverged: whether it was refused for that.
    """

    kind: str
    seed: int
    picks: list[list[float]]
    places: list[list[float]]
    seconds: float
    rest: float = 0.0
    ever: float = 0.0
    pressed: float = 0.0
    short: float = 0.0
    slipped: float = 0.0
    height: float = 0.0
    diverged: bool = False


def main(arguments: Sequence[str] | None = None) -> None:
    """Fold what is missing, and print the table and the worst."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.extremes", description=__doc__)
    parser.add_argument("--folds", type=int, default=1000, help="two on each garment (default 1000)")
    parser.add_argument("--seed", type=int, default=5000, help="first garment seed (default 5000)")
    parser.add_argument("--worst", type=int, default=5, help="how many of the worst are listed (default 5)")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--out", type=Path, default=Path("runs/extremes"), help="keeps the folds (runs/extremes)")
    options = parser.parse_args(arguments)
    folds = _folds(options)
    print("\n".join(table(folds)))
    for what in ("seconds", "ever", "height"):
        print(f"\nWorst by {_TOLD[what]}:")
        for fold in sorted(folds, key=lambda fold: getattr(fold, what), reverse=True)[: options.worst]:
            picks, places = np.round(fold.picks).tolist(), np.round(fold.places).tolist()
            told = f"{fold.seconds:.1f} s, stretched by {fold.rest:.0%}, {fold.ever:.0%} on the way"
            print(f"  {fold.kind} {fold.seed}: {picks} to {places}: {told}, {1000 * fold.height:.0f} mm high")


_TOLD = {"seconds": "time", "ever": "stretch on the way", "height": "height"}


def _folds(options: argparse.Namespace) -> list[Extreme]:
    """Those asked for, by garment; what was kept before is not made again."""
    from tqdm import tqdm

    options.out.mkdir(parents=True, exist_ok=True)
    kept = JsonLines(options.out / "folds.jsonl")
    found = {record["seed"]: [Extreme(**fold) for fold in record["folds"]] for record in kept.read()}
    wanted = range(options.seed, options.seed + -(-options.folds // 2))
    missing = [seed for seed in wanted if seed not in found]
    jobs = in_processes(extreme_folds, missing, options.workers)
    for seed, folds in tqdm(jobs, total=len(missing), file=sys.stderr, mininterval=2.0):
        kept.append({"seed": seed, "folds": [asdict(fold) for fold in folds]})
        found[seed] = folds
    return [fold for seed in wanted for fold in found[seed]][: options.folds]


def extreme_folds(seed: int) -> list[Extreme]:
    """Two folds in a row on one garment."""
    simulator = plugins.create("simulators", "xpbd")
    kind, rng = KINDS[seed % 4], np.random.default_rng(seed)
    garment = plugins.generate_garment(kind, seed, EDGE)

    def stretched() -> NDArray[np.float64]:
        return strain(garment.mesh, simulator.state().positions)

    picture, folds = simulator.reset(garment, seed), []
    for _ in range(2):
        action = _extreme_action(cloth_mask(picture), rng)
        told: dict[str, Any] = {"picks": action.picks.round(2).tolist(), "places": action.places.round(2).tolist()}
        on_the_way: list[float] = []
        simulator.record(lambda _, seen=on_the_way: seen.append(float(stretched().max())), LOOKS)
        clock = time.process_time()
        try:
            picture = simulator.execute(action)
        except SimulationError:
            folds.append(Extreme(kind, seed, **told, seconds=time.process_time() - clock, diverged=True))
            continue
        told["seconds"], state, at_rest = time.process_time() - clock, simulator.state(), stretched()
        told["rest"], told["pressed"] = float(at_rest.max()), float(-at_rest.min())
        told["ever"], told["height"] = max(*on_the_way, told["rest"]), float(state.positions[:, 2].max())
        told["short"], told["slipped"] = max(state.short or (0.0,)), max(state.slipped or (0.0,))
        folds.append(Extreme(kind, seed, **told))
    return folds


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
    rest, ever = np.array([[fold.rest, fold.ever] for fold in folds]).T
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
        ("arms out of whose grip cloth slipped", str(sum(fold.slipped > 0 for fold in folds))),
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
    usual = {
        kind: statistics.median(fold.seconds for fold in folds if fold.kind == kind)
        for kind in {fold.kind for fold in folds}
    }
    return sum(fold.seconds > 5 * usual[fold.kind] for fold in folds)


def _three(shares: NDArray[np.float64]) -> str:
    return ", ".join(f"{100 * value:.0f} %" for value in (np.median(shares), np.percentile(shares, 99), shares.max()))


if __name__ == "__main__":
    main()
