"""What becomes of folds and grips in the robot cell: ``python -m experiments.benchmarks.cell.grips``.

Every fifth task of the suite is folded by the default agent on one garment each, as in ``experiments/robot_cell.toml``,
once for each depth to which the fingers bite. Counted are folds by how the arms did them, grips that took nothing and
grips that left lower plies, and for the last depth the seconds of each stage: those of the arms as planned, the others
as this computer takes (paper, Fig. 11 c).
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import polyfold
from polyfold.config import Experiment
from polyfold.plugins import find, generate_garment
from polyfold.rollout import run_episode
from polyfold.studies import Study
from polyfold.tasks import Task, load_suite
from polyfold.types import Episode

STUDY = Path(__file__).parents[2] / "robot_cell.toml"
SEED = 3000
"""Garments that the study does not fold."""
EVERY = 5


@dataclass
class Tally:
    """What became of the folds with one depth.

    Attributes:
        bite: how far below the measured surface the fingers close [m].
        folds: by how they were done.
        taken, missed, partial: grips that took all plies, nothing, or left lower plies.
        off: how far each tool was from what was meant [m].
        arms: how long the arms moved in each fold [s].
        stages: seconds of each stage, summed.
        steps: folds that were tried.
    """

    bite: float
    folds: Counter[str] = field(default_factory=Counter)
    taken: int = 0
    missed: int = 0
    partial: int = 0
    off: list[float] = field(default_factory=list)
    arms: list[float] = field(default_factory=list)
    stages: Counter[str] = field(default_factory=Counter)
    steps: int = 0

    def add(self, episode: Episode) -> None:
        """Count an episode."""
        self.steps += len(episode.steps)
        self.stages.update({name: s for name, s in episode.seconds.items() if name not in ("reset", "execution")})
        for fold in episode.final_state.extra["cell"]:
            self.folds[fold["mode"]] += 1
            self.arms.append(fold["seconds"])
            self.stages["arms move"] += fold["seconds"]
            for grip in fold["grips"]:
                self.off.append(grip["off"])
                self.missed += grip["taken"] == 0
                self.partial += grip["taken"] > 0 and grip["left"] > 0
                self.taken += grip["taken"] > 0 and grip["left"] == 0


def main(arguments: Sequence[str] | None = None) -> None:
    """Fold, count and print."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cell.grips", description=__doc__)
    parser.add_argument("--bites", type=float, nargs="+", default=[0, 1, 2, 4, 10], metavar="MM")
    parser.add_argument("--tasks", type=int, help="so many of the tasks only")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="where the time goes, as a pie")
    options = parser.parse_args(arguments)
    from tqdm import tqdm

    study = polyfold.load(STUDY)
    tasks = load_suite(str(find("tasks", study.suite).target)).tasks[::EVERY][: options.tasks]
    tallies = [Tally(bite / 1000) for bite in options.bites]
    for tally, task in tqdm([(tally, task) for tally in tallies for task in tasks], file=sys.stderr, mininterval=5.0):
        tally.add(_fold(study, task, tally.bite))
    print("\n".join(table(tallies, len(tasks))))
    if options.picture:
        _pie(tallies[-1], options.picture)


def _fold(study: Study, task: Task, bite: float) -> Episode:
    experiment = Experiment.of(simulator={"name": "pybullet", "bite": bite})
    garment = generate_garment(
        task.garment, SEED, study.edge_length, experiment.fabric, size=study.sizes.get(task.garment)
    )
    return run_episode(experiment, garment, task.instructions[0], SEED)


def table(tallies: Sequence[Tally], tasks: int) -> list[str]:
    """The figures as lines of Markdown."""
    lines = [
        f"{tasks} tasks for each depth, on garments of seed {SEED}",
        "",
        "| bite | grips | all plies | nothing | lower plies left | tool off, mean | p95 |",
        "|---|---|---|---|---|---|---|",
    ]
    for tally in tallies:
        grips = tally.taken + tally.missed + tally.partial
        shares = (f"{count} ({count / max(grips, 1):.1%})" for count in (tally.taken, tally.missed, tally.partial))
        off = 1000 * np.array(tally.off or [np.nan])
        lines.append(
            f"| {1000 * tally.bite:g} mm | {grips} | {' | '.join(shares)} | {off.mean():.1f} mm | "
            f"{np.percentile(off, 95):.1f} mm |"
        )
    folds = sum((tally.folds for tally in tallies), Counter[str]())
    every = [seconds for tally in tallies for seconds in tally.arms if seconds]
    lines += ["", "| folds | number | share |", "|---|---|---|"]
    lines += [f"| {mode} | {count} | {count / folds.total():.1%} |" for mode, count in folds.most_common()]
    lines += [
        "",
        f"The arms move for {np.median(every):.1f} s a fold (median; 95 % within {np.percentile(every, 95):.1f}).",
    ]
    last = tallies[-1]
    whole = sum(last.stages.values())
    lines += ["", "| stage | seconds a fold | share |", "|---|---|---|"]
    lines += [
        f"| {name} | {seconds / max(last.steps, 1):.2f} | {seconds / whole:.1%} |"
        for name, seconds in last.stages.most_common()
    ]
    return lines


def _pie(tally: Tally, path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure((5, 3.4), layout="constrained")
    axes = figure.add_subplot()
    stages = [(name, seconds) for name, seconds in tally.stages.most_common() if seconds]
    wedges, _ = axes.pie([seconds for _, seconds in stages], startangle=90)
    told = [f"{name}: {seconds / max(tally.steps, 1):.2f} s" for name, seconds in stages]
    axes.legend(wedges, told, loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, frameon=False)
    axes.set_title("a fold in the robot cell", fontsize=10)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main()
