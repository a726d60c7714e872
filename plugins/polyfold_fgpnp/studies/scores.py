"""What a study of trainings found, on the episodes that all its variants have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from polyfold.analysis import Estimate, Results, mean
from polyfold.errors import ConfigError, did_you_mean
from polyfold.logs import StudyEpisodeRecord
from polyfold_fgpnp.studies.variants import Learned, learned
from polyfold_fgpnp.training.runs import TrainingRun

Floats = NDArray[np.float64]
Episode = tuple[str, int, str, int]
"""Kind and seed of the garment, task, wording."""

ALL = "all"
SUCCESS = "success"


class Scores:
    """What the variants of a study scored on the episodes that all of them have.

    Args:
        results: of a study by ``curves study``.
        score: ``success``, by the study's own criterion, or the name of a metric.

    Attributes:
        label, digits: how scores are shown.
        learned: the variants that were learned.
        others: names of those that were not.
        episodes: which count.
        kinds: their kinds of garment, and :data:`ALL`.

    Raises:
        ConfigError: if there is no such score, nothing was learned, or no episode is there for every variant yet.
    """

    def __init__(self, results: Results, score: str = SUCCESS) -> None:
        self.label, self.digits = _shown(results, score)
        found = {variant: _scored(results.of(variant), score) for variant in results.study.variants}
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
        """Mean score of a variant, on a kind of garment or on all."""
        return float(self._values[variant][self._of(kind)].mean())

    def over_runs(self, points: Sequence[Learned], kind: str = ALL) -> Floats:
        """Mean score of each of some trainings, shape (runs,)."""
        return np.array([self.mean(point.variant, kind) for point in points])

    def over_garments(self, variants: Sequence[str]) -> Estimate:
        """Score, the mean of some variants, with an interval for other garments."""
        values = np.mean([self._values[variant] for variant in variants], axis=0)
        return mean(values.tolist(), [(kind, seed) for kind, seed, *_ in self.episodes])

    def by_epoch(self) -> dict[int, list[Learned]]:
        """The trainings evaluated after each epoch. Raises ConfigError if their data sizes differ."""
        if len({point.folds for point in self.learned}) > 1:
            raise ConfigError(
                "the evaluation has several data sizes; draw it with `curves sizes`, or evaluate one of them"
            )
        epochs = sorted({point.epoch for point in self.learned})
        return {epoch: [point for point in self.learned if point.epoch == epoch] for epoch in epochs}

    def by_folds(self) -> dict[int, list[Learned]]:
        """The trainings on each number of folds, each after its last epoch."""
        last: dict[tuple[int, int], Learned] = {}
        for point in sorted(self.learned):
            last[point.folds, point.seed] = point
        sizes = sorted({folds for folds, _ in last})
        return {size: [point for (folds, _), point in last.items() if folds == size] for size in sizes}

    def _of(self, kind: str) -> NDArray[np.bool_]:
        return np.array([kind in (ALL, episode[0]) for episode in self.episodes])


def _shown(results: Results, score: str) -> tuple[str, int]:
    """Heading of a score, and its digits after the point."""
    if score == SUCCESS:
        return "success %", 1
    metrics = results.run.metrics
    if score not in metrics:
        raise ConfigError(f"there is no score {score!r}; {did_you_mean(score, [SUCCESS, *metrics])}")
    return metrics[score].heading, metrics[score].digits


def _scored(records: Sequence[StudyEpisodeRecord], score: str) -> dict[Episode, float]:
    """Scores of the episodes that have one."""
    scores = {
        (r.garment.kind, r.garment.seed, r.task or "", r.wording): _score(r, score)
        for r in records
        if r.garment.seed is not None
    }
    return {episode: found for episode, found in scores.items() if found is not None}


def _score(record: StudyEpisodeRecord, score: str) -> float | None:
    return 100.0 * record.succeeded if score == SUCCESS else record.metrics.get(score)


def metric_by_epoch(runs: Sequence[TrainingRun], name: str) -> Floats:
    """A metric that trainings logged, shape (runs, epochs), as far as all of them have come.

    Raises:
        ConfigError: if one of them has not finished an epoch.
    """
    epochs = min(len(run.metrics) for run in runs)
    if epochs == 0:
        raise ConfigError("one of the trainings has not finished an epoch; wait for it, or leave it out")
    return np.array([[entry[name] for entry in run.metrics[:epochs]] for run in runs])
