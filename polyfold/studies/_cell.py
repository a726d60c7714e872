"""One episode of a study: run, compare with references, say why it failed. The unit of work that travels to workers."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.errors import ActionError, GroundingError, PlanError, SimulationError
from polyfold.evaluation import suite
from polyfold.evaluation._attribution import attribute, attribute_open
from polyfold.evaluation._criteria import criteria
from polyfold.evaluation._judging import final_mask, first_mask
from polyfold.evaluation._references import Reference, ideal_reference, reference_for
from polyfold.evaluation._scoring import Comparison, compare_end
from polyfold.evaluation._suites import accepted_tasks
from polyfold.garments import Garment
from polyfold.logs import StudyEpisodeRecord
from polyfold.logs._records import BoundsRecord
from polyfold.logs._writing import episode_fields, finite
from polyfold.plugins.interfaces import Goal
from polyfold.rollout import run_episode
from polyfold.rollout._inputs import GUIDED, PRIVILEGED
from polyfold.rollout._loop import build_agent
from polyfold.studies._cells import Cell
from polyfold.studies._study import Study, experiment_of
from polyfold.tasks import OpenTask, Task, fold_lines
from polyfold.tasks._goals import measure
from polyfold.types import Decision, Episode, Failure, Observation, Outcome, Subgoal

PICTURES = ("none", "failed", "all")
"""Which episodes get a picture; ``failed`` includes the first episode of each task, so that successes are seen too."""

Render = Callable[[Episode, NDArray[np.bool_] | None], bytes]
"""Draws an episode, over its end the outline of the wanted silhouette, bool, shape (H, W), if there is one."""

Scored = tuple[StudyEpisodeRecord, bytes | None]
"""A scored episode and its picture, if one was asked for; it travels back so that workers need not share a disk."""


def evaluate_cell(study: Study, cell: Cell, pictures: str = "none", render: Render | None = None) -> Scored:
    """Run one episode and score it.

    The pose depends on the garment's seed alone, so that all variants and wordings start from the same picture as the
    oracle. A goal without given folds (:class:`polyfold.tasks.OpenTask`) is compared with the nearest of the tasks that
    it accepts, and its record's ``done`` says which of its own bounds the end keeps.

    Args:
        study, cell: what to run.
        pictures: one of :data:`PICTURES`: whether this episode gets one.
        render: draws it; None for no pictures.
    """
    started = datetime.now(UTC)
    entry = suite(study.suite).entry(cell.task)
    accepted = (entry,) if isinstance(entry, Task) else accepted_tasks(study.suite, entry)
    episode = _run(study, cell, entry, accepted)
    try:
        references = _references(study, cell, accepted, episode)
    except (ActionError, GroundingError, PlanError, SimulationError) as error:
        failure = Failure("infrastructure", f"the oracle failed: {error}")
        references, episode = [], replace(episode, failure=episode.failure or failure)
    end = Outcome(episode.initial_state, episode.final_state, final_mask(episode), episode.garment.mesh)
    metrics = {name: plugins.create("metrics", name, study.metrics.get(name)) for name in plugins.names("metrics")}
    comparison = compare_end(end, references, metrics, criteria(study.criteria))
    record = _record(study, cell, _Judged(entry, episode, end.mask, comparison), started)
    if render is None or not _is_pictured(study, cell, record, pictures):
        return record, None
    nearest = comparison.nearest
    return record, render(episode, None if nearest is None else nearest.outcome.mask)


def _is_pictured(study: Study, cell: Cell, record: StudyEpisodeRecord, pictures: str) -> bool:
    first = cell.garment_seed == study.first_seed and cell.wording == 0
    return pictures == "all" or (pictures == "failed" and (first or not record.succeeded))


@dataclass(frozen=True, eq=False)
class _Judged:
    """An episode with what was found out about its end.

    Attributes:
        entry: what was asked for.
        episode: what happened.
        mask: the cloth in the last picture, bool, shape (H, W).
        comparison: the end beside its references.
    """

    entry: Task | OpenTask
    episode: Episode
    mask: NDArray[np.bool_]
    comparison: Comparison


class _Idle:
    """Stands in for an agent that can't be told what to do."""

    requires: ClassVar[frozenset[str]] = frozenset()

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        return None


def _garment(study: Study, cell: Cell, experiment: Experiment) -> Garment:
    """The garment of an episode; variants that differ in the fabric alone share the mesh."""
    cut = _cut(cell.garment, cell.garment_seed, study.edge_length, study.sizes.get(cell.garment))
    return replace(cut, fabric=plugins.make_fabric(experiment.fabric, cell.garment))


@lru_cache(maxsize=8)
def _cut(kind: str, seed: int, edge_length: float, size: float | None) -> Garment:
    return plugins.generate_garment(kind, seed, edge_length, size=size)


def _run(study: Study, cell: Cell, entry: Task | OpenTask, accepted: Sequence[Task]) -> Episode:
    """The episode; guidance, for agents that need it, is made from the first accepted task."""
    experiment = experiment_of(study, cell.variant)
    garment = _garment(study, cell, experiment)
    instruction = entry.instructions[cell.wording] if entry.instructions else ""
    agent = build_agent(experiment)
    if accepted or not agent.requires & GUIDED:
        task = accepted[0] if accepted else None
        return run_episode(
            experiment, garment, instruction, cell.garment_seed, agent=agent, task=task, agent_seed=cell.agent_seed
        )
    failure = Failure(
        "infrastructure",
        f"the agent {experiment.agent.name!r} needs guidance, which is made from a task, and {entry.id} accepts none; "
        "give it goals with 'accept' only",
    )
    return run_episode(
        experiment,
        garment,
        instruction,
        cell.garment_seed,
        agent=_Idle(),
        agent_seed=cell.agent_seed,
        judge=lambda idle: replace(idle, failure=failure, privileged=bool(agent.requires & PRIVILEGED)),
    )


def _references(study: Study, cell: Cell, accepted: Sequence[Task], episode: Episode) -> list[Reference]:
    if study.reference == "ideal":
        return [ideal_reference(task, episode.garment, episode.initial_state) for task in accepted]
    simulator = episode.experiment.simulator
    return [reference_for(task, episode.garment, cell.garment_seed, simulator) for task in accepted]


def _record(study: Study, cell: Cell, judged: _Judged, started: datetime) -> StudyEpisodeRecord:
    entry, episode, comparison = judged.entry, judged.episode, judged.comparison
    done = _done(judged)
    success = {
        name: episode.failure is None and (holds or (done is not None and done.holds))
        for name, holds in comparison.success.items()
    }
    return StudyEpisodeRecord(
        **episode_fields(episode, started, datetime.now(UTC), keep_messages=False),
        task=cell.task,
        key=cell.key,
        variant=cell.variant,
        factors=study.factors.get(cell.variant, {}),
        type=entry.type,
        split=entry.split if isinstance(entry, Task) else None,
        steps_wanted=len(entry.steps) if isinstance(entry, Task) else None,
        wording=cell.wording,
        wording_unseen=_is_unseen(study, cell),
        metrics={name: finite(value, 4) for name, value in comparison.values.items()},
        done=done,
        step_errors_mm=_step_errors(episode, comparison.nearest),
        success=success,
        cause=None if success[study.criteria[0]] else _cause(judged),
        reference_idle=comparison.nearest is not None and comparison.nearest.is_idle(),
        peak_memory_mb=_peak_memory_mb(),
    )


def _peak_memory_mb() -> int | None:
    """The largest memory that this process had so far [MiB]; None on Windows, where Python can't tell."""
    try:
        import resource
    except ModuleNotFoundError:
        return None
    a_mebibyte = 2**20 if sys.platform == "darwin" else 2**10
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / a_mebibyte)


def _is_unseen(study: Study, cell: Cell) -> bool | None:
    unseen = suite(study.suite).unseen_wordings
    return None if unseen is None else cell.wording in unseen


def _done(judged: _Judged) -> BoundsRecord | None:
    """What a goal's own bounds say about the end; None where it has none."""
    if isinstance(judged.entry, Task) or judged.entry.done is None:
        return None
    measured = measure(judged.mask, first_mask(judged.episode), len(judged.episode.final_attempts()))
    failing = judged.entry.done.failing(measured)
    values = {name: round(value, 4) if isinstance(value, float) else value for name, value in vars(measured).items()}
    return BoundsRecord(holds=not failing, failing=tuple(failing), measured=values)


def _cause(judged: _Judged) -> str:
    episode, nearest = judged.episode, judged.comparison.nearest
    if isinstance(judged.entry, OpenTask):
        return attribute_open(episode, judged.mask)
    if nearest is None:
        return "infrastructure"
    return attribute(episode, fold_lines(judged.entry, episode.initial_state.keypoint_pixels()), nearest)


def _step_errors(episode: Episode, reference: Reference | None) -> tuple[float | None, ...]:
    """Mean particle error [mm] after each of the episode's own steps, where the reference has such a step."""
    if reference is None:
        return ()
    errors = []
    for step, wanted in zip(episode.final_attempts(), reference.after, strict=False):
        distance = np.linalg.norm(step.after.positions - wanted.positions, axis=1)
        errors.append(finite(1000.0 * float(distance.mean()), 4))
    return tuple(errors)
