"""Learning curves as figures (the paper's Figs. 10 and 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from polyfold.viz import PALETTE
from polyfold_fgpnp.studies.scores import ALL, Scores, metric_by_epoch
from polyfold_fgpnp.studies.variants import Learned
from polyfold_fgpnp.training.runs import TrainingRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]


def training_figure(runs: Sequence[TrainingRun], found: Scores | None = None) -> Figure:
    """Loss and rank correlation over epochs above, a score below once evaluated: mean and standard deviation."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 5.6 if found else 3.0), layout="constrained")
    panels = figure.subplots(2 if found else 1, sharex=True, squeeze=False)[:, 0]
    loss, correlation = metric_by_epoch(runs, "loss"), metric_by_epoch(runs, "rank_correlation")
    epochs = np.arange(1, loss.shape[1] + 1)
    _band(panels[0], epochs, loss, PALETTE[0])
    _named(panels[0], "training loss", PALETTE[0])
    right = panels[0].twinx()
    _band(right, epochs, correlation, PALETTE[1])
    _named(right, "rank correlation,\nheld-out states", PALETTE[1])
    right.spines["top"].set_visible(False)
    if found:
        by_epoch = found.by_epoch()
        _draw_scores(panels[1], by_epoch, found, ALL)
        panels[1].set_ylabel(found.label)
        panels[1].legend(frameon=False, fontsize=8, loc="best")
    panels[-1].set_xlabel("epoch")
    panels[0].set_title(f"mean and standard deviation over trainings, n = {len(runs)}", fontsize=10)
    return figure


def sizes_figure(found: Scores) -> Figure:
    """A score over the number of folds that were learned from, a panel for each kind of garment and one for all."""
    from matplotlib.figure import Figure

    sizes = found.by_folds()
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
