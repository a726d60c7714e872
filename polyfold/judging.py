"""How well an episode went: against the ideal fold, along a known task's lines where the fold is one."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.episode import Episode
from polyfold.errors import ConfigError, GroundingError, PluginError
from polyfold.goals import OpenTask
from polyfold.ideal import fidelity
from polyfold.tasks import Suite, Task, fold_lines, load_suite, recognise
from polyfold.types import FoldLine, Observation

__all__ = ["accepted_tasks", "final_mask", "find_task", "first_mask", "judge", "known_tasks", "suite"]


def suite(name: str) -> Suite:
    """A registered task suite by name, its goals checked against the suite whose tasks they accept.

    Raises:
        PluginError: if there is no such suite.
        ConfigError: if its file is wrong.
    """
    return _checked(name, str(plugins.find("tasks", name).target))


def accepted_tasks(name: str, goal: OpenTask) -> tuple[Task, ...]:
    """The tasks whose end states count as reaching a goal of the registered suite ``name``; often none."""
    return _accepted(name, suite(name), goal)


@cache
def _checked(name: str, target: str) -> Suite:
    found = _loaded(target)
    for goal in found.goals:
        _accepted(name, found, goal)
    return found


@cache
def _loaded(target: str) -> Suite:
    return load_suite(target)


def _loaded_by_name(name: str) -> Suite:
    """Without a check of its own goals, so that two suites may accept tasks of each other."""
    return _loaded(str(plugins.find("tasks", name).target))


def _accepted(name: str, found: Suite, goal: OpenTask) -> tuple[Task, ...]:
    if not goal.accept:
        return ()
    where = str(plugins.find("tasks", name).target)
    try:
        source = found if found.accept_from in (name, found.name) else _loaded_by_name(found.accept_from)
    except PluginError as error:
        raise ConfigError(f"{where}: goal {goal.id}, field accept: {error}; set accept_from to such a suite") from error
    try:
        tasks = tuple(source.task(task_id) for task_id in goal.accept)
    except ConfigError as error:
        raise ConfigError(f"{where}: goal {goal.id}, field accept: {error}") from error
    for task in tasks:
        if task.garment != goal.garment:
            raise ConfigError(
                f"{where}: goal {goal.id}, field accept: {task.id} is for a {task.garment}, "
                f"the goal for a {goal.garment}; accept tasks of its own garment"
            )
    return tasks


def known_tasks(kind: str) -> list[Task]:
    """The tasks of all installed suites for a kind of garment."""
    return [task for name in plugins.names("tasks") for task in suite(name).for_garment(kind)]


def find_task(task_id: str, kind: str) -> Task:
    """A task by id. Raises ConfigError, naming what is known for the kind, if there is none."""
    tasks = known_tasks(kind)
    for task in tasks:
        if task.id == task_id:
            return task
    known = ", ".join(task.id for task in tasks)
    raise ConfigError(f"no task for a {kind} is called {task_id!r}; choose one of: {known or 'none is installed'}")


def final_mask(episode: Episode) -> NDArray[np.bool_]:
    """The cloth in the last picture, bool, shape (H, W); empty if it was carried out of sight."""
    return _cloth(episode, episode.final)


def first_mask(episode: Episode) -> NDArray[np.bool_]:
    """The flat cloth in the first picture, bool, shape (H, W); empty if the segmenter finds none."""
    return _cloth(episode, episode.start)


def _cloth(episode: Episode, seen: Observation) -> NDArray[np.bool_]:
    try:
        return episode.experiment.create("segmenters", "segmenter").segment(seen)
    except GroundingError:
        return np.zeros(seen.depth.shape, bool)


def judge(episode: Episode, task_id: str | None = None) -> Episode:
    """The episode with its fidelity.

    The ideal lines come from the true keypoints if a task is named or the plan is recognised as one; otherwise they are
    the planned lines, and the fidelity is labelled ``self-referenced``.
    """
    keypoints = episode.initial_state.keypoint_pixels()
    planned = [step.fold_line for step in episode.settled() if step.fold_line is not None]
    if task_id is None and not episode.steps:
        return episode
    if task_id is None:
        task_id = recognise(known_tasks(episode.garment.kind), keypoints, planned)
    lines: list[FoldLine] = (
        planned if task_id is None else fold_lines(find_task(task_id, episode.garment.kind), keypoints)
    )
    found = fidelity(
        final_mask(episode),
        episode.final_state,
        episode.initial_state,
        episode.garment.mesh,
        lines,
        "self-referenced" if task_id is None else "keypoints",
    )
    return replace(episode, task=task_id, fidelity=found, ideal_lines=tuple(lines))
