"""What the baselines have learned: ``python -m experiments.benchmarks.baselines runs/baselines --picture curves.png``.

Prints a Markdown table of the trainings in a folder of ``python -m experiments.baselines``, finished ones: what each
learned from, for how long, and how far its picks are from those demonstrated on garments that it never saw, in pixels
of a view of 128 x 128 about the garment. Below them, what no learning gives there: the picks of the closest
demonstration of another garment, copied, and a random pixel of the cloth. What has no picks to compare (``vcd``
predicts where cloth goes, ``ppo`` learns by trying) has none. The picture shows the pick errors as they fell.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import on_cloth
from polyfold_baselines.learning.command import EVERY, row_class
from polyfold_baselines.learning.examples import held_out
from polyfold_baselines.learning.networks.heatmaps import pick_error, points_of
from polyfold_baselines.learning.weights import Weights, load

from polyfold.analysis import Table, mean, shown
from polyfold.errors import PolyfoldError
from polyfold.logs import JsonLines

ERROR = "pick_error_px"
HEADERS = ("row", "learned from", "garments", "folds", "passes", "minutes", "parameters", "MB", "pick error [px]")


@dataclass(frozen=True)
class Training:
    """A finished one.

    Attributes:
        row: the baseline.
        path: its folder.
        weights: what came of it.
        demos: what it learned from; None if by trying.
    """

    row: str
    path: Path
    weights: Weights
    demos: Demos | None

    def cells(self) -> tuple[str, ...]:
        """Its row of the table."""
        parameters = sum(parameter.numel() for parameter in self.weights.network.parameters())
        megabytes = (self.path / "weights.safetensors").stat().st_size / 1e6
        learned = ("trying", "–", "–") if self.demos is None else _told(self.demos)
        error = self.weights.measured.get(ERROR)
        return (
            f"`{self.row}`",
            *learned,
            f"{self.weights.config['passes']:,}",
            f"{self.weights.minutes:.0f}",
            f"{parameters:,}",
            f"{megabytes:.1f}",
            "–" if error is None else f"{error:.1f}",
        )


def main(arguments: list[str] | None = None) -> int:
    """Print the table, and draw; returns 1, with a message, if that can't be done."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.baselines", description=__doc__)
    parser.add_argument("runs", type=Path, help="folder of python -m experiments.baselines")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="draw the pick errors as they fell")
    options = parser.parse_args(arguments)
    try:
        every = {found.hash: found for found in _demonstrations(options.runs)}
        trainings = list(_trainings(options.runs, every))
        print(table(trainings, list(every.values())).markdown())
        if options.picture is not None:
            _draw(trainings, options.picture)
    except PolyfoldError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    return 0


def table(trainings: list[Training], demonstrations: list[Demos]) -> Table:
    """The trainings, and what no learning gives on the same garments."""
    rows = [training.cells() for training in trainings]
    for demos in demonstrations:
        if demos.plan.agent == "random-drags":
            continue
        source, garments, folds = _told(demos)
        for name, picks in (("nearest demonstration", copied(demos)), ("random pixel", at_random(demos))):
            true = points_of(demos.columns["picks"], demos.columns["places"])[held_out(demos)]
            seeds = demos.columns["garment_seed"][held_out(demos)]
            error = shown(mean(pick_error(picks, true).tolist(), seeds.tolist()))
            rows.append((name, source, garments, folds, "–", "–", "–", "–", error))
    return Table(
        list(HEADERS), [list(row) for row in rows], "Pick errors are on garments that nothing was learned from."
    )


def copied(demos: Demos) -> NDArray[np.float64]:
    """Picks on held-out garments, those of the most alike other demonstration of the kind [px], shape (N, arms, 2)."""
    columns, apart = demos.columns, held_out(demos)
    goals = np.unpackbits(columns["goal_mask"], axis=-1).reshape(demos.masks.shape).astype(bool)
    found = []
    for row in np.flatnonzero(apart).tolist():
        others = np.flatnonzero(~apart & (columns["kind"] == columns["kind"][row]))
        alike = sum(_overlaps(masks[row], masks[others]) for masks in (demos.masks, goals))
        found.append(_on_cloth(demos, row, columns["picks"][others[int(np.argmax(alike))]]))
    return np.stack(found)


def at_random(demos: Demos) -> NDArray[np.float64]:
    """Random pixels of the cloth of held-out garments [px], shape (N, arms, 2)."""
    rng = np.random.default_rng(0)
    cloths = (np.argwhere(demos.masks[row])[:, ::-1] for row in np.flatnonzero(held_out(demos)))
    return np.stack([rng.choice(cloth, demos.plan.arms).astype(float) for cloth in cloths])


def _on_cloth(demos: Demos, row: int, picks: NDArray[np.float32]) -> NDArray[np.float64]:
    there = np.where(np.isfinite(picks), picks, picks[:1])[: demos.plan.arms]
    return on_cloth(there, demos.masks[row])


def _overlaps(mask: NDArray[np.bool_], others: NDArray[np.bool_]) -> NDArray[np.float64]:
    return (others & mask).sum((1, 2)) / np.maximum((others | mask).sum((1, 2)), 1)


def _told(demos: Demos) -> tuple[str, str, str]:
    arms = "one arm" if demos.plan.arms == 1 else "two arms"
    source = "random drags" if demos.plan.agent == "random-drags" else f"{demos.plan.split} tasks, {arms}"
    return source, str(len(np.unique(demos.columns["garment_seed"]))), f"{len(demos):,}"


def _demonstrations(runs: Path) -> Iterator[Demos]:
    for described in sorted(runs.glob("*/dataset.json")):
        yield Demos.read(described.parent)


def _trainings(runs: Path, demonstrations: dict[str, Demos]) -> Iterator[Training]:
    for row in EVERY:
        file = runs / row / "weights.safetensors"
        if file.exists():
            weights = load(file, row, row_class(row).network)
            yield Training(row, file.parent, weights, demonstrations.get(str(weights.config.get("demos"))))


def _draw(trainings: list[Training], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    for training in trainings:
        entries = [entry for entry in JsonLines(training.path / "metrics.jsonl").read() if ERROR in entry]
        if entries:
            passes, errors = ([float(entry[name]) for entry in entries] for name in ("passes", ERROR))
            axes.plot(passes, errors, label=training.row, linewidth=1.5)
    axes.set(xlabel="folds looked at", ylabel="pick error on held-out garments [px of 128]", ylim=(0, None))
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    sys.exit(main())
