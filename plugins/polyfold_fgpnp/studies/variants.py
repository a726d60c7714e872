"""The study that asks how well what trainings have learned folds, by epoch, seed and data size."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.tasks import Task
from polyfold_fgpnp.training.runs import TrainingRun

BASELINE = "affordance-pair"
"""The policy without learning that every curve is drawn beside."""

POLICY_OF = {"csam": "csam+caso"}
"""Policies that are not called as the variant of the network they ask."""


class Learned(NamedTuple):
    """What a variant of a study was learned from: the folds, the training's seed, and the epochs done."""

    folds: int
    seed: int
    epoch: int

    @property
    def variant(self) -> str:
        """Name of the variant, such as ``folds=10000,seed=0,epoch=60``."""
        return ",".join(f"{name}={value}" for name, value in self._asdict().items())


def learned(variant: str) -> Learned | None:
    """Read the name of a variant; None for one that was not learned, such as ``affordance-pair``."""
    found = re.fullmatch(r"folds=(\d+),seed=(\d+),epoch=(\d+)", variant)
    return Learned(*map(int, found.groups())) if found else None


def few_tasks(per_kind: int, steps: str | None = None, name: str = "polyfold70") -> list[str]:
    """Ids of a few tasks of each kind of garment in a suite, by a rule that knows nothing but their ids.

    Of a kind's N tasks in the order of their ids those at floor((k + 1/2) N / n) are taken, k = 0 ... n - 1: the
    middles of n equal parts, and all of them if N is not more than n.

    Args:
        per_kind: n.
        steps: only tasks of one fold (``single``), or only those of several (``multi``).
        name: of the suite.
    """
    kinds: dict[str, list[str]] = {}
    for task in suite(name).entries:
        if isinstance(task, Task) and steps in (None, "single" if len(task.steps) == 1 else "multi"):
            kinds.setdefault(task.garment, []).append(task.id)
    return [
        sorted(ids)[(2 * k + 1) * len(ids) // (2 * min(per_kind, len(ids)))]
        for ids in kinds.values()
        for k in range(min(per_kind, len(ids)))
    ]


def study_of(
    runs: Iterable[TrainingRun],
    name: str,
    tasks: Sequence[str],
    garments: int,
    first_seed: int = 0,
    last: bool = False,
) -> dict[str, Any]:
    """A study of trainings, plain data for TOML: the true fold lines, one variant for each file of weights, and none.

    As in ``experiments/policies.toml`` an episode's agent is the oracle that knows the fold lines and sees with the
    camera, and results are compared with the ideal fold, so that nothing but the policy differs.

    Args:
        runs: trainings.
        name: of the study.
        tasks: ids, see :func:`few_tasks`.
        garments: number of garments per kind.
        first_seed: of the garments.
        last: only the last weights of each training.

    Raises:
        ConfigError: if a training has no weights yet, or two of them have the same seed and number of folds.
    """
    variants: dict[str, Any] = {BASELINE: {"policy": BASELINE}}
    for run in runs:
        weights = run.weights()
        if not weights:
            raise ConfigError(f"{run.path} has no weights yet; finish the training, or give it snapshots")
        for epoch in [max(weights)] if last else weights:
            variant = Learned(run.folds, run.config["seed"], epoch).variant
            if variant in variants:
                raise ConfigError(f"{run.path} is a second training of {variant}; give one of each seed and data size")
            network = run.config["network"]["variant"]
            policy = {"name": POLICY_OF.get(network, network), "weights": str(weights[epoch])}
            variants[variant] = {"policy": policy}
    return {
        "name": name,
        "tasks": list(tasks),
        "garments": garments,
        "first_seed": first_seed,
        "reference": "ideal",
        "base": {"agent": {"name": "fold-lines", "ground": True}},
        "variants": variants,
    }
