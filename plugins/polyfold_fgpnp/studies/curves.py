"""How learning goes on and what more data gives: ``python -m polyfold_fgpnp.curves`` (the paper's Figs. 10 and 8).

First train, with ``snapshots`` in the TOML file, once per seed or data size; then let a study fold with every file of
weights; then draw. Paths in the study are those given here, relative to where one runs:

    polyfold train experiments/training/pair.toml --seed 1 --out runs/pair-s1
    python -m polyfold_fgpnp.curves study runs/pair-s* > curve.toml
    polyfold evaluate curve.toml --out runs/curve
    python -m polyfold_fgpnp.curves training runs/pair-s* --evaluation runs/curve --out training.png

    polyfold train experiments/training/pair.toml --folds 2500 --out runs/pair-2500
    python -m polyfold_fgpnp.curves study --last --steps multi runs/pair-2500 runs/pair-5000 runs/pair-s0 > sizes.toml
    polyfold evaluate sizes.toml --out runs/sizes
    python -m polyfold_fgpnp.curves sizes runs/sizes --out sizes.png

Each drawing is a PNG, and a Markdown table on the standard output. ± is the standard deviation over trainings, with
n - 1; it says how much the seed matters and nothing about which garments were drawn. For that the tables have a 95 %
bootstrap interval over garments, whose episodes are kept together, of the score averaged over trainings. Of a study
that is not finished only the episodes count that all its variants have. Choosing an epoch by these curves and reporting
its success on the same garments would be tuning on them. With fewer folds as many epochs are fewer steps, and the last
tenth of the garments, which is held out, is another one: compare data sizes by what is evaluated, not by their logs.
Where nearly every fold succeeds, ``--score moved-part`` tells more apart.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from polyfold.analysis import Estimate, Results, Table, open_results, ratio, shown
from polyfold.errors import ConfigError, PolyfoldError
from polyfold.viz import PALETTE
from polyfold_fgpnp.training.runs import Learned, TrainingRun, few_tasks, learned, read_run, study_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


Floats = NDArray[np.float64]
Record = Mapping[str, Any]
Episode = tuple[str, int, str, int]
"""Kind and seed of the garment, task, wording."""

ALL = "all"
SCORES: Mapping[str, tuple[str, int, Callable[[Record], float | None]]] = {
    "success": ("success %", 1, lambda record: 100.0 * record["success"]["polyfold"]),
    "moved-part": ("moved part [mm]", 1, lambda record: record["metrics"]["moved-part"]),
    "mppe": ("MPPE [mm]", 1, lambda record: record["metrics"]["mppe"]),
    "miou": ("mIoU", 3, lambda record: record["metrics"]["miou"]),
}
"""What can be drawn: its label, digits after the point, and how an episode's record says it."""

ROWS = 10
"""Rows of the table of a training that was not evaluated."""


class Scores:
    """What the variants of a study scored on the episodes that all of them have.

    Args:
        results: of a study by ``curves study``.
        score: one of :data:`SCORES`.

    Raises:
        ConfigError: if nothing in it was learned, or no episode is there for every variant yet.
    """

    def __init__(self, results: Results, score: str = "success") -> None:
        self.label, self.digits, of = SCORES[score]
        found = {variant: _scored(results.of(variant), of) for variant in results.study.variants}
        self.learned = [point for point in map(learned, found) if point is not None]
        if not self.learned:
            raise ConfigError(f"nothing in the study {results.study.name!r} was learned; make it with `curves study`")
        self.episodes = sorted(set.intersection(*(set(scores) for scores in found.values())))
        if not self.episodes:
            raise ConfigError(f"no episode of {results.study.name!r} is there for every variant yet; evaluate the rest")
        self.kinds = [*(kind for kind in results.kinds() if any(kind == e[0] for e in self.episodes)), ALL]
        self.others = [variant for variant in found if learned(variant) is None]
        self._values = {
            variant: np.array([scores[episode] for episode in self.episodes]) for variant, scores in found.items()
        }

    def mean(self, variant: str, kind: str = ALL) -> float:
        """Mean score of a variant."""
        return float(self._values[variant][self._of(kind)].mean())

    def over_runs(self, points: Sequence[Learned], kind: str = ALL) -> Floats:
        """Mean score of each of some trainings, shape (runs,)."""
        return np.array([self.mean(point.variant, kind) for point in points])

    def over_garments(self, variants: Sequence[str]) -> Estimate:
        """Score, the mean of some variants, with an interval from drawing garments."""
        values = np.mean([self._values[variant] for variant in variants], axis=0)
        garments: dict[tuple[str, int], list[float]] = {}
        for (kind, seed, *_), value in zip(self.episodes, values, strict=True):
            garments.setdefault((kind, seed), []).append(value)
        return ratio([sum(found) for found in garments.values()], [len(found) for found in garments.values()])

    def _of(self, kind: str) -> NDArray[np.bool_]:
        return np.array([kind in (ALL, episode[0]) for episode in self.episodes])


def _scored(records: Sequence[Record], of: Callable[[Record], float | None]) -> dict[Episode, float]:
    """Scores of the episodes that have one."""
    scores = {(r["garment"], r["garment_seed"], r["task"], r["wording"]): of(r) for r in records}
    return {episode: float(score) for episode, score in scores.items() if score is not None}


def _metric(runs: Sequence[TrainingRun], name: str) -> Floats:
    """A metric of trainings by epoch, shape (runs, epochs), as far as all of them have come."""
    epochs = min(len(run.metrics) for run in runs)
    if epochs == 0:
        raise ConfigError("one of the trainings has not finished an epoch; wait for it, or leave it out")
    return np.array([[entry[name] for entry in run.metrics[:epochs]] for run in runs])


def _by_epoch(found: Scores) -> dict[int, list[Learned]]:
    """The trainings evaluated after each epoch, one data size."""
    if len({point.folds for point in found.learned}) > 1:
        raise ConfigError("the evaluation has several data sizes; draw it with `curves sizes`, or evaluate one of them")
    epochs = sorted({point.epoch for point in found.learned})
    return {epoch: [point for point in found.learned if point.epoch == epoch] for epoch in epochs}


def _by_folds(found: Scores) -> dict[int, list[Learned]]:
    """The trainings on each number of folds, each after its last epoch."""
    last: dict[tuple[int, int], Learned] = {}
    for point in sorted(found.learned):
        last[point.folds, point.seed] = point
    sizes = sorted({folds for folds, _ in last})
    return {size: [point for (folds, _), point in last.items() if folds == size] for size in sizes}


def training_table(runs: Sequence[TrainingRun], found: Scores | None = None) -> Table:
    """Loss and rank correlation on held-out states of trainings by epoch and, once evaluated, a score.

    Without an evaluation every so many epochs make a row.
    """
    loss, correlation = _metric(runs, "loss"), _metric(runs, "rank_correlation")
    done = loss.shape[1]
    points = {} if found is None else _by_epoch(found)
    epochs = list(points) or sorted({round(epoch) for epoch in np.linspace(1, done, min(ROWS, done))})
    rows = []
    for epoch in epochs:
        logged = [_spread(values[:, epoch - 1], 3) if epoch <= done else "–" for values in (loss, correlation)]
        rows.append([str(epoch), *logged, *(_score_cells(found, points[epoch]) if found else [])])
    headers = ["epoch", "loss", "rank correlation", *(_score_headers(found) if found else [])]
    rows += [] if found is None else [[other, "–", "–", *_other_cells(found, other)] for other in found.others]
    return Table(headers, rows, f"Mean ± standard deviation over trainings (n = {len(runs)}).{_note(found)}")


def sizes_table(found: Scores) -> Table:
    """A score by the number of folds that were learned from, by kind of garment, beside what learns nothing."""
    rows = [[str(folds), *_score_cells(found, points)] for folds, points in _by_folds(found).items()]
    rows += [[other, *_other_cells(found, other)] for other in found.others]
    note = f"Mean ± standard deviation over trainings, each after its last epoch.{_note(found)}"
    return Table(["folds", *_score_headers(found)], rows, note)


def _score_headers(found: Scores) -> list[str]:
    return ["trainings", *(f"{kind}, {found.label}" for kind in found.kinds), "95 % over garments"]


def _score_cells(found: Scores, points: Sequence[Learned]) -> list[str]:
    spreads = [_spread(found.over_runs(points, kind), found.digits) for kind in found.kinds]
    return [str(len(points)), *spreads, shown(found.over_garments([point.variant for point in points]), found.digits)]


def _other_cells(found: Scores, variant: str) -> list[str]:
    means = [f"{found.mean(variant, kind):.{found.digits}f}" for kind in found.kinds]
    return ["–", *means, shown(found.over_garments([variant]), found.digits)]


def _spread(values: Floats, digits: int) -> str:
    """Mean ± standard deviation; the value alone if there is one."""
    deviation = f" ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else ""
    return f"{values.mean():.{digits}f}{deviation}"


def _note(found: Scores | None) -> str:
    if found is None:
        return ""
    garments = len({episode[:2] for episode in found.episodes})
    tasks = len({episode[2] for episode in found.episodes})
    return f" All fold the same {len(found.episodes)} episodes: {tasks} tasks, {garments} garments."


def training_figure(runs: Sequence[TrainingRun], found: Scores | None = None) -> Figure:
    """Loss and rank correlation over epochs above, a score below once evaluated: mean and standard deviation."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 5.6 if found else 3.0), layout="constrained")
    panels = figure.subplots(2 if found else 1, sharex=True, squeeze=False)[:, 0]
    loss, correlation = _metric(runs, "loss"), _metric(runs, "rank_correlation")
    epochs = np.arange(1, loss.shape[1] + 1)
    _band(panels[0], epochs, loss, PALETTE[0])
    _named(panels[0], "training loss", PALETTE[0])
    right = panels[0].twinx()
    _band(right, epochs, correlation, PALETTE[1])
    _named(right, "rank correlation,\nheld-out states", PALETTE[1])
    right.spines["top"].set_visible(False)
    if found:
        by_epoch = _by_epoch(found)
        _draw_scores(panels[1], by_epoch, found, ALL)
        panels[1].set_ylabel(found.label)
        panels[1].legend(frameon=False, fontsize=8, loc="best")
    panels[-1].set_xlabel("epoch")
    panels[0].set_title(f"mean and standard deviation over trainings, n = {len(runs)}", fontsize=10)
    return figure


def sizes_figure(found: Scores) -> Figure:
    """A score over the number of folds that were learned from, a panel for each kind of garment and one for all."""
    from matplotlib.figure import Figure

    sizes = _by_folds(found)
    figure = Figure(figsize=(1.0 + 2.1 * len(found.kinds), 2.9), layout="constrained")
    panels = figure.subplots(1, len(found.kinds), sharey=True, squeeze=False)[0]
    for axes, kind in zip(panels, found.kinds, strict=True):
        _draw_scores(axes, sizes, found, kind)
        axes.set_title(kind, fontsize=10)
        axes.set_xscale("log")
        axes.set_xticks(list(sizes), [f"{folds:,}" for folds in sizes], rotation=45, fontsize=8)
        axes.minorticks_off()
    panels[0].set_ylabel(found.label)
    panels[-1].legend(frameon=False, fontsize=8, loc="best")
    figure.supxlabel("folds learned from", fontsize=10)
    return figure


def _draw_scores(axes: Axes, points: Mapping[int, Sequence[Learned]], found: Scores, kind: str) -> None:
    values = [found.over_runs(some, kind) for some in points.values()]
    means, spans = zip(*[(v.mean(), v.std(ddof=1) if len(v) > 1 else np.nan) for v in values], strict=True)
    axes.errorbar(
        list(points), means, yerr=spans, color=PALETTE[2], marker="o", ms=4, capsize=3, lw=1.5, label="learned"
    )
    for number, other in enumerate(found.others):
        colour = PALETTE[(5 + number) % len(PALETTE)]
        axes.axhline(found.mean(other, kind), color=colour, ls="--", lw=1.2, label=f"{other}, not learned")
    axes.spines[["top", "right"]].set_visible(False)


def _band(axes: Axes, x: NDArray[np.int64], values: Floats, colour: str) -> None:
    """Mean and standard deviation of values, shape (runs, len(x))."""
    mean = values.mean(axis=0)
    axes.plot(x, mean, color=colour, lw=1.5)
    if len(values) > 1:
        deviation = values.std(axis=0, ddof=1)
        axes.fill_between(x, mean - deviation, mean + deviation, color=colour, alpha=0.25, lw=0)


def _named(axes: Axes, name: str, colour: str) -> None:
    axes.set_ylabel(name, color=colour)
    axes.tick_params(axis="y", colors=colour)
    axes.spines["top"].set_visible(False)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write a study, or draw; returns 1, with a message, if that can't be done."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except PolyfoldError as error:
        print(f"polyfold_fgpnp.curves: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m polyfold_fgpnp.curves", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    verbs = parser.add_subparsers(required=True, metavar="VERB")
    study = verbs.add_parser("study", help="print a study, TOML, that folds with the weights of trainings")
    study.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="folders of `polyfold train`")
    study.add_argument("--last", action="store_true", help="only the last weights of each, not its snapshots")
    study.add_argument("--name", default="curve", help="of the study (default: curve)")
    study.add_argument("--tasks-per-kind", type=int, default=5, metavar="N", help="default: 5")
    study.add_argument("--steps", choices=["single", "multi"], help="only tasks of one fold, or of several")
    study.add_argument("--garments", type=int, default=3, metavar="N", help="per kind (default: 3)")
    study.add_argument("--first-seed", type=int, default=0, metavar="SEED", help="of the garments (default: 0)")
    study.set_defaults(run=_print_study)
    training = verbs.add_parser("training", help="loss, rank correlation and success over epochs (Fig. 10)")
    training.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="folders of `polyfold train`, one per seed")
    training.add_argument("--evaluation", type=Path, metavar="DIR", help="run directory of the study")
    training.add_argument("--out", type=Path, default=Path("training.png"), metavar="PNG", help="default: training.png")
    training.set_defaults(run=_draw_training)
    training.add_argument("--score", choices=list(SCORES), default="success", help="default: success")
    sizes = verbs.add_parser("sizes", help="success by data size (Fig. 8)")
    sizes.add_argument("evaluation", type=Path, metavar="DIR", help="run directory of the study")
    sizes.add_argument("--out", type=Path, default=Path("sizes.png"), metavar="PNG", help="default: sizes.png")
    sizes.set_defaults(run=_draw_sizes)
    sizes.add_argument("--score", choices=list(SCORES), default="success", help="default: success")
    return parser


def _print_study(options: argparse.Namespace) -> None:
    import tomli_w

    if options.tasks_per_kind < 1:
        raise ConfigError(f"--tasks-per-kind {options.tasks_per_kind} leaves no task; give 1 or more")
    tasks = few_tasks(options.tasks_per_kind, options.steps)
    runs = [read_run(path) for path in options.runs]
    study = study_of(runs, options.name, tasks, options.garments, options.first_seed, options.last)
    print("# By `python -m polyfold_fgpnp.curves study`: of each kind's tasks, sorted by id, those in the middle of")
    print(f"# {options.tasks_per_kind} equal parts. Paths are relative to where one runs.")
    print(tomli_w.dumps(study), end="")


def _draw_training(options: argparse.Namespace) -> None:
    runs = [read_run(path) for path in options.runs]
    found = None if options.evaluation is None else Scores(open_results(options.evaluation), options.score)
    _save(training_figure(runs, found), options.out)
    print(training_table(runs, found).markdown())


def _draw_sizes(options: argparse.Namespace) -> None:
    found = Scores(open_results(options.evaluation), options.score)
    _save(sizes_figure(found), options.out)
    print(sizes_table(found).markdown())


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    raise SystemExit(main())
