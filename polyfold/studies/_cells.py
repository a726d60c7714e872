"""The episodes of a study, one by one."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from polyfold import plugins
from polyfold.errors import ConfigError, did_you_mean
from polyfold.evaluation import suite
from polyfold.studies._study import Study, experiment_of
from polyfold.tasks import OpenTask, Task


@dataclass(frozen=True)
class Cell:
    """One episode of a study, by names alone, so that it travels to any worker.

    Attributes:
        variant, task: names within the study and its suite.
        garment: kind of garment.
        garment_seed: picks the garment, and how it lies on the table: the same for every variant and wording.
        wording: which of the task's sentences is said.
        agent_seed: decides the agent's random choices: the same for every variant.
    """

    variant: str
    task: str
    garment: str
    garment_seed: int
    wording: int
    agent_seed: int

    @property
    def key(self) -> str:
        """Unique name within the study."""
        return f"{self.variant}/{self.task}/{self.garment_seed}/{self.wording}"


def _check_metrics(study: Study) -> None:
    """Raises ConfigError or PluginError if parameters are given to a metric that has none or does not exist."""
    for name, params in study.metrics.items():
        plugins.create("metrics", name, params)


def _check_sizes(study: Study) -> None:
    """Raises ConfigError if a size is given for a kind of garment that the suite has not."""
    kinds = sorted({task.garment for task in suite(study.suite).entries})
    for kind in study.sizes:
        if kind not in kinds:
            raise ConfigError(f"sizes names {kind!r}, of which {study.suite} has no task; {did_you_mean(kind, kinds)}")


def _agent_seed(study: Study, task: Task | OpenTask, garment_seed: int, wording: int) -> int:
    """A hash of run, task, garment and wording: no two episodes of a variant share it, and no order matters."""
    name = f"{study.seed}/{task.id}/{garment_seed}/{wording}"
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:4], "big")


def cells(study: Study) -> Iterator[Cell]:
    """Every episode of a study, in a fixed order that mixes kinds, so that progress is representative."""
    for variant in study.variants:
        experiment_of(study, variant)
    _check_metrics(study)
    chosen = _chosen_tasks(study)
    _check_sizes(study)
    for index in range(study.garments):
        for task, variant in itertools.product(chosen, study.variants):
            garment_seed = study.first_seed + index
            for wording in _wordings(study, task, index):
                seed = _agent_seed(study, task, garment_seed, wording)
                yield Cell(variant, task.id, task.garment, garment_seed, wording, seed)


def _chosen_tasks(study: Study) -> list[Task | OpenTask]:
    chosen = [task for task in suite(study.suite).matching(study.tasks) if _is_chosen(study, task)]
    if not chosen:
        raise ConfigError(
            f"no task of {study.suite!r} is left by tasks={list(study.tasks)}, split={study.split!r} and "
            f"steps={study.steps!r}; widen one of them"
        )
    return chosen


def _is_chosen(study: Study, task: Task | OpenTask) -> bool:
    if isinstance(task, OpenTask):
        return study.split is None and study.steps is None
    return study.split in (None, task.split) and study.steps in (None, "single" if len(task.steps) == 1 else "multi")


def _wordings(study: Study, task: Task | OpenTask, index: int) -> Sequence[int]:
    count = max(1, len(task.instructions))
    return {"first": [0], "in-turn": [index % count], "all": range(count)}[study.instructions]
