"""One episode of a study: run, compare with the oracle, say why it failed. The unit of work that travels to workers."""

from __future__ import annotations

import math
import resource
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import SimulationError
from polyfold.evaluation import (
    PRESETS,
    Reference,
    accepted_tasks,
    attribute,
    attribute_open,
    final_mask,
    first_mask,
    ideal_reference,
    needed_scale,
    reference_for,
    succeeded,
    suite,
)
from polyfold.garments import Garment
from polyfold.plugins.interfaces import Goal
from polyfold.rollout import build_agent, run_episode
from polyfold.rollout._loop import GUIDED, PRIVILEGED
from polyfold.studies._cells import Cell
from polyfold.studies._study import Study, experiment_of
from polyfold.tasks import OpenTask, Task, fold_lines, measure
from polyfold.types import Decision, Episode, Failure, Observation, Outcome, Subgoal

Record = dict[str, Any]


@lru_cache(maxsize=8)
def _garment(kind: str, seed: int, edge_length: float) -> Garment:
    return plugins.create("garments", kind).generate(seed, edge_length)


@dataclass(frozen=True, eq=False)
class _Comparison:
    """An episode beside its references.

    Attributes:
        values: metrics against the nearest reference, NaN without one.
        nearest: the reference whose thresholds are met most easily; None without any.
        success: whether all thresholds of a preset hold against one and the same reference, by preset.
    """

    values: Mapping[str, float]
    nearest: Reference | None
    success: Mapping[str, bool]


class _Idle:
    """Stands in for an agent that can't be told what to do."""

    requires: ClassVar[frozenset[str]] = frozenset()

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        return None


def evaluate_cell(study: Study, cell: Cell) -> Record:
    """Run one episode and score it; plain data.

    The pose depends on the garment's seed alone, so that all variants and wordings start from the same picture as the
    oracle. A goal without given folds (:mod:`polyfold.goals`) is compared with the nearest of the tasks that it
    accepts, and its record's ``done`` says which of its own bounds the end keeps.
    """
    return _evaluated(study, cell)[0]


PICTURES = ("none", "failed", "all")
"""Which episodes get a picture; ``failed`` includes the first episode of each task, so that successes are seen too."""

Render = Callable[[Episode, NDArray[np.bool_] | None], bytes]
"""Draws an episode, over its end the outline of the wanted silhouette, bool, shape (H, W), if there is one."""


def evaluate_with_picture(study: Study, cell: Cell, pictures: str, render: Render) -> tuple[Record, bytes | None]:
    """As :func:`evaluate_cell`, with the episode's small picture if ``pictures`` asks for one.

    The picture travels back with the record, so that workers need not share a file system.

    Args:
        study, cell: what to run.
        pictures: one of :data:`PICTURES`.
        render: draws it.
    """
    record, episode, nearest = _evaluated(study, cell)
    first = cell.garment_seed == study.first_seed and cell.wording == 0
    if pictures == "all" or (pictures == "failed" and (first or not record["success"]["polyfold"])):
        return record, render(episode, None if nearest is None else nearest.outcome.mask)
    return record, None


def _evaluated(study: Study, cell: Cell) -> tuple[Record, Episode, Reference | None]:
    entry = suite(study.suite).entry(cell.task)
    accepted = (entry,) if isinstance(entry, Task) else accepted_tasks(study.suite, entry)
    episode = _run(study, cell, entry, accepted)
    try:
        references = _references(study, cell, accepted, episode)
    except SimulationError as error:
        failure = Failure("infrastructure", f"the oracle failed: {error}")
        references, episode = [], replace(episode, failure=failure)
    comparison = _compare(study, episode, references)
    return _record(cell, entry, episode, comparison), episode, comparison.nearest


def _run(study: Study, cell: Cell, entry: Task | OpenTask, accepted: Sequence[Task]) -> Episode:
    """The episode; guidance, for agents that need it, is made from the first accepted task."""
    garment = _garment(cell.garment, cell.garment_seed, study.edge_length)
    experiment = experiment_of(study, cell.variant)
    instruction = entry.instructions[cell.wording] if entry.instructions else ""
    agent = build_agent(experiment)
    if accepted or not agent.requires & GUIDED:
        task = accepted[0] if accepted else None
        return run_episode(
            experiment, garment, instruction, cell.garment_seed, agent=agent, task=task, agent_seed=cell.seed
        )
    idle = run_episode(experiment, garment, instruction, cell.garment_seed, agent=_Idle())
    failure = Failure(
        "infrastructure",
        f"the agent {experiment.agent.name!r} needs guidance, which is made from a task, and {entry.id} accepts none; "
        "give it goals with 'accept' only",
    )
    return replace(idle, failure=failure, privileged=bool(agent.requires & PRIVILEGED))


def _references(study: Study, cell: Cell, accepted: Sequence[Task], episode: Episode) -> list[Reference]:
    if study.reference == "ideal":
        return [ideal_reference(task, episode.garment, episode.initial_state) for task in accepted]
    simulator = episode.experiment.simulator
    return [reference_for(task, episode.garment, cell.garment_seed, simulator) for task in accepted]


def _compare(study: Study, episode: Episode, references: Sequence[Reference]) -> _Comparison:
    if not references:
        return _Comparison(dict.fromkeys(plugins.names("metrics"), math.nan), None, dict.fromkeys(PRESETS, False))
    result = Outcome(episode.initial_state, episode.final_state, final_mask(episode))
    metrics = {name: plugins.create("metrics", name, study.metrics.get(name)) for name in plugins.names("metrics")}
    scores = [
        {name: metric.score(result, [reference.outcome]) for name, metric in metrics.items()}
        for reference in references
    ]
    nearest = min(range(len(scores)), key=lambda index: needed_scale(scores[index]))
    success = {preset: any(succeeded(values, preset) for values in scores) for preset in PRESETS}
    return _Comparison(scores[nearest], references[nearest], success)


def _record(cell: Cell, entry: Task | OpenTask, episode: Episode, comparison: _Comparison) -> Record:
    done = _done(entry, episode)
    reached = {preset: holds or bool(done and done["holds"]) for preset, holds in comparison.success.items()}
    success = {preset: episode.failure is None and holds for preset, holds in reached.items()}
    return {
        "variant": cell.variant,
        "task": cell.task,
        "type": entry.type,
        "split": entry.split if isinstance(entry, Task) else None,
        "steps_wanted": len(entry.steps) if isinstance(entry, Task) else None,
        "garment": cell.garment,
        "garment_seed": cell.garment_seed,
        "wording": cell.wording,
        "instruction": episode.instruction,
        "subgoals": [subgoal.text for subgoal in episode.subgoals],
        "steps": len(episode.final_attempts()),
        "retries": sum(step.retry for step in episode.steps),
        "values_picks": any(step.action_map is not None for step in episode.steps),
        "metrics": {name: _number(value) for name, value in comparison.values.items()},
        "done": done,
        "step_errors_mm": _step_errors(episode, comparison.nearest),
        "success": success,
        "failure": None if episode.failure is None else vars(episode.failure),
        "cause": None if success["polyfold"] else _cause(episode, entry, comparison.nearest),
        "privileged": episode.privileged,
        "language": episode.transcript.accounts(),
        "seconds": {stage: round(spent, 4) for stage, spent in episode.seconds.items()},
        "peak_memory_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
    }


def _done(entry: Task | OpenTask, episode: Episode) -> Record | None:
    """What a goal's own bounds say about the end; None where it has none."""
    if isinstance(entry, Task) or entry.done is None:
        return None
    measured = measure(final_mask(episode), first_mask(episode), len(episode.final_attempts()))
    failing = entry.done.failing(measured)
    values = {name: round(value, 4) if isinstance(value, float) else value for name, value in vars(measured).items()}
    return {"holds": not failing, "failing": list(failing), "measured": values}


def _cause(episode: Episode, entry: Task | OpenTask, reference: Reference | None) -> str:
    if isinstance(entry, OpenTask):
        return attribute_open(episode, final_mask(episode))
    if reference is None:
        return "infrastructure"
    return attribute(episode, fold_lines(entry, episode.initial_state.keypoint_pixels()), reference)


def _step_errors(episode: Episode, reference: Reference | None) -> list[float | None]:
    """Mean particle error [mm] after each of the episode's own steps, where the reference has such a step."""
    if reference is None:
        return []
    errors = []
    for step, wanted in zip(episode.final_attempts(), reference.after, strict=False):
        distance = np.linalg.norm(step.after.positions - wanted.positions, axis=1)
        errors.append(_number(1000.0 * float(distance.mean())))
    return errors


def _number(value: float) -> float | None:
    return round(float(value), 4) if math.isfinite(value) else None
