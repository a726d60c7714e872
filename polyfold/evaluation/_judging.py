"""How well an episode went: against the ideal fold, along a known task's lines where the fold is one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import GroundingError
from polyfold.evaluation._suites import find_task, known_tasks
from polyfold.geometry import FoldLine
from polyfold.tasks import fold_lines
from polyfold.tasks._ideal import fidelity
from polyfold.tasks._lines import recognise
from polyfold.types import Episode, Observation


def final_mask(episode: Episode) -> NDArray[np.bool_]:
    """The cloth in the last picture, bool, shape (H, W); empty if it was carried out of sight."""
    return _cloth(episode, episode.final)


def first_mask(episode: Episode) -> NDArray[np.bool_]:
    """The flat cloth in the first picture, bool, shape (H, W); empty if the segmenter finds none."""
    return _cloth(episode, episode.start)


def _cloth(episode: Episode, seen: Observation) -> NDArray[np.bool_]:
    try:
        return plugins.create_chosen(episode.experiment, "segmenter").segment(seen)
    except GroundingError:
        return np.zeros(seen.depth.shape, bool)


def judge(episode: Episode, task_id: str | None = None) -> Episode:
    """The episode with its fidelity.

    The ideal lines come from the true keypoints if a task is named or the plan is recognised as one; otherwise they are
    the planned lines, and the fidelity is labelled ``self-referenced``.
    """
    keypoints = episode.initial_state.keypoint_pixels()
    planned = [step.fold_line for step in episode.final_attempts() if step.fold_line is not None]
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
        episode.garment,
        lines,
        "self-referenced" if task_id is None else "keypoints",
    )
    return replace(episode, task=task_id, fidelity=found, ideal_lines=tuple(lines))
