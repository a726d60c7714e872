"""Learning curves as tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from polyfold.analysis import Table, shown
from polyfold_fgpnp.studies.scores import Scores, metric_by_epoch
from polyfold_fgpnp.studies.variants import Learned
from polyfold_fgpnp.training.runs import TrainingRun

Floats = NDArray[np.float64]

ROWS = 10
"""Rows of the table of a training that was not evaluated."""


def training_table(runs: Sequence[TrainingRun], found: Scores | None = None) -> Table:
    """Loss and rank correlation on held-out states of trainings by epoch and, once evaluated, a score.

    Without an evaluation every so many epochs make a row.
    """
    loss, correlation = metric_by_epoch(runs, "loss"), metric_by_epoch(runs, "rank_correlation")
    done = loss.shape[1]
    points = {} if found is None else found.by_epoch()
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
    rows = [[str(folds), *_score_cells(found, points)] for folds, points in found.by_folds().items()]
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
