"""One episode of a study: run, compare with the oracle, say why it failed. The unit of work that travels to workers."""

from __future__ import annotations

import math
import resource
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from polyfold import plugins
from polyfold.attribution import attribute
from polyfold.episode import Episode, Failure, run_episode
from polyfold.errors import SimulationError
from polyfold.garments import Garment
from polyfold.judging import final_mask, suite
from polyfold.references import Reference, ideal_reference, reference_for
from polyfold.scoring import PRESETS, Outcome, succeeded
from polyfold.study import Cell, Study, experiment_of
from polyfold.tasks import Task, fold_lines
from polyfold.thumbnails import thumbnail

__all__ = ["evaluate_cell", "evaluate_with_picture"]

Record = dict[str, Any]


@lru_cache(maxsize=8)
def _garment(kind: str, seed: int, edge_length: float) -> Garment:
    return plugins.create("garments", kind).generate(seed, edge_length)


def evaluate_cell(study: Study, cell: Cell) -> Record:
    """Run one episode and score it; plain data.

    The pose depends on the garment's seed alone, so that all variants and wordings start from the same picture as the
    oracle.
    """
    task = suite(study.suite).task(cell.task)
    return _record(study, cell, task, *_run(study, cell, task))


def evaluate_with_picture(study: Study, cell: Cell, pictures: str) -> tuple[Record, bytes | None]:
    """As :func:`evaluate_cell`, with the episode's small picture (WebP) if ``pictures`` asks for one.

    The picture travels back with the record, so that workers need not share a file system.

    Args:
        study, cell: what to run.
        pictures: one of :data:`polyfold.thumbnails.PICTURES`.
    """
    task = suite(study.suite).task(cell.task)
    episode, reference = _run(study, cell, task)
    record = _record(study, cell, task, episode, reference)
    first = cell.garment_seed == study.first_seed and cell.wording == 0
    if pictures == "all" or (pictures == "failed" and (first or not record["success"]["polyfold"])):
        return record, thumbnail(episode, None if reference is None else reference.outcome.mask)
    return record, None


def _run(study: Study, cell: Cell, task: Task) -> tuple[Episode, Reference | None]:
    """The episode and what it is compared with; None where the oracle itself failed, which ends no study."""
    garment = _garment(cell.garment, cell.garment_seed, study.edge_length)
    experiment = experiment_of(study, cell.variant)
    instruction = task.instructions[cell.wording] if task.instructions else ""
    episode = run_episode(experiment, garment, instruction, cell.garment_seed, task=task, agent_seed=cell.seed)
    if study.reference == "ideal":
        return episode, ideal_reference(task, garment, episode.initial_state)
    try:
        return episode, reference_for(task, garment, cell.garment_seed, experiment.simulator)
    except SimulationError as error:
        return replace(episode, failure=Failure("infrastructure", f"the oracle failed: {error}")), None


def _record(study: Study, cell: Cell, task: Task, episode: Episode, reference: Reference | None) -> Record:
    values = _scores(study, episode, reference)
    success = {preset: episode.failure is None and succeeded(values, preset) for preset in PRESETS}
    return {
        "variant": cell.variant,
        "task": cell.task,
        "type": task.type,
        "split": task.split,
        "steps_wanted": len(task.steps),
        "garment": cell.garment,
        "garment_seed": cell.garment_seed,
        "wording": cell.wording,
        "instruction": episode.instruction,
        "subgoals": [subgoal.text for subgoal in episode.subgoals],
        "steps": len(episode.settled()),
        "retries": sum(step.retry for step in episode.steps),
        "metrics": {name: _number(value) for name, value in values.items()},
        "step_errors_mm": _step_errors(episode, reference),
        "success": success,
        "failure": None if episode.failure is None else vars(episode.failure),
        "cause": None if success["polyfold"] else _cause(episode, task, reference),
        "privileged": episode.privileged,
        "seconds": {stage: round(spent, 4) for stage, spent in episode.seconds.items()},
        "peak_memory_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
    }


def _cause(episode: Episode, task: Task, reference: Reference | None) -> str:
    if reference is None:
        return "infrastructure"
    return attribute(episode, fold_lines(task, episode.initial_state.keypoint_pixels()), reference)


def _scores(study: Study, episode: Episode, reference: Reference | None) -> Mapping[str, float]:
    if reference is None:
        return dict.fromkeys(plugins.names("metrics"), math.nan)
    result = Outcome(episode.initial_state, episode.final_state, final_mask(episode))
    return {
        name: plugins.create("metrics", name, study.metrics.get(name)).score(result, [reference.outcome])
        for name in plugins.names("metrics")
    }


def _step_errors(episode: Episode, reference: Reference | None) -> list[float | None]:
    """Mean particle error [mm] after each of the episode's own steps, where the reference has such a step."""
    if reference is None:
        return []
    errors = []
    for step, wanted in zip(episode.settled(), reference.after, strict=False):
        distance = np.linalg.norm(step.after.positions - wanted.positions, axis=1)
        errors.append(_number(1000.0 * float(distance.mean())))
    return errors


def _number(value: float) -> float | None:
    return round(float(value), 4) if math.isfinite(value) else None
