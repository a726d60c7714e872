"""Random folds, planned and swept: ``python -m experiments.benchmarks.cell.folds --robot panda --folds 500``.

Says how many folds the arms do at once, one after the other, by one arm, or not, and why; and looks for collisions in
every plan with a sweep of its own. Prints Markdown.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.planning import FoldPlan, FoldPlanner, Infeasible
from polyfold_pybullet.robots import robot_model

from experiments.benchmarks.cell.drawn import DrawnFold, drawn_folds
from experiments.benchmarks.cell.sweep import DENSITY, Swept, sweep

WORKSPACES = {"panda": ((0.0, 0.0), (0.3, 0.5)), "yumi": ((0.0, -0.02), (0.25, 0.4))}
"""Middle of the cloths [m], and their shortest and longest side [m]."""


@dataclass(frozen=True, eq=False)
class Tried:
    """One fold, what planning it came to, how long that took [s], and what the sweep found."""

    fold: DrawnFold
    plan: FoldPlan | Infeasible
    seconds: float
    swept: Swept | None


def main(arguments: Sequence[str] | None = None) -> None:
    """Plan, sweep and print."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cell.folds", description=__doc__)
    parser.add_argument("--robot", choices=sorted(WORKSPACES), default="panda")
    parser.add_argument("--folds", type=int, default=500)
    parser.add_argument("--seed", type=int, default=2000)
    options = parser.parse_args(arguments)
    from tqdm import tqdm

    centre, sides = WORKSPACES[options.robot]
    model = robot_model(options.robot)
    folds = islice(drawn_folds(options.seed, centre, sides), options.folds)
    with Cell(model) as cell, Cell(model, lean=False) as other:
        planner = FoldPlanner(cell)
        tried = [
            _try(planner, other, fold) for fold in tqdm(folds, total=options.folds, file=sys.stderr, mininterval=2.0)
        ]
    print("\n".join(table(tried, options.robot, sides)))


def _try(planner: FoldPlanner, other: Cell, fold: DrawnFold) -> Tried:
    clock = time.perf_counter()
    plan = planner.plan(fold.picks, fold.places)
    seconds = time.perf_counter() - clock
    return Tried(fold, plan, seconds, sweep(other, plan) if isinstance(plan, FoldPlan) else None)


def table(tried: Sequence[Tried], robot: str, sides: tuple[float, float]) -> list[str]:
    """The figures as lines of Markdown."""
    count = len(tried)
    plans = [one.plan for one in tried if isinstance(one.plan, FoldPlan)]
    refused = [one.plan for one in tried if isinstance(one.plan, Infeasible)]
    swept = [one.swept for one in tried if one.swept is not None]
    lines = [
        f"{robot}: {count} random folds of cloths of {100 * sides[0]:.0f} to {100 * sides[1]:.0f} cm",
        "",
        "| outcome | folds | share | duration, median |",
        "|---|---|---|---|",
    ]
    for mode in ("at once", "in sequence", "one arm"):
        durations = [plan.duration for plan in plans if plan.mode == mode]
        middle = f"{np.median(durations):.1f} s" if durations else "–"
        lines.append(f"| {mode} | {len(durations)} | {len(durations) / count:.1%} | {middle} |")
    for stage, folds in Counter(plan.stage for plan in refused).most_common():
        lines.append(f"| infeasible: {stage} | {folds} | {folds / count:.1%} | – |")
    seconds = [one.seconds for one in tried]
    lines += [
        "",
        "| figure | value | n |",
        "|---|---|---|",
        f"| time to plan: median, p95, largest | {np.median(seconds):.2f}, {np.percentile(seconds, 95):.2f}, "
        f"{max(seconds):.2f} s | {count} |",
        f"| rows looked at afterwards, {DENSITY} times as dense | {sum(one.rows for one in swept)} | {len(swept)} |",
        f"| plans with a collision | {sum(bool(one.collisions) for one in swept)} | {len(swept)} |",
    ]
    if swept:
        least = [1000 * min(getattr(one, what) for one in swept) for what in ("arms", "obstacles")]
        lines += [
            f"| least distance between the arms | {least[0]:.1f} mm | {len(swept)} |",
            f"| least distance from table, torso and posts | {least[1]:.1f} mm | {len(swept)} |",
        ]
    lines += [f"- {plan.stage}: {plan.reason}" for plan in refused[:10]]
    lines += [f"- collision in {found}" for one in swept for found in one.collisions[:1]]
    return lines


if __name__ == "__main__":
    main()
