"""How well an episode went: beside the ideal fold of what was asked for, as far as anything but the plan tells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import GroundingError
from polyfold.evaluation._criteria import criteria, succeeded
from polyfold.evaluation._suites import find_task, known_tasks
from polyfold.evaluation._undisturbed import undisturbed
from polyfold.geometry import FoldLine, iou
from polyfold.tasks import Task, fold_lines
from polyfold.tasks._ideal import fidelity, fold_ideally
from polyfold.tasks._lines import recognise
from polyfold.types import Episode, Observation, Outcome
from polyfold.types._fidelity import Fidelity, Reference, Verdict

VERDICTS: Sequence[tuple[Verdict, str, float]] = (("good", "strict", 70.0), ("fair", "lenient", 40.0))
"""Verdicts with the criteria that earn them and the quality that they need besides, the best first: what is crumpled,
or whose edges hang back, may keep within the bounds on means."""

QUALITY = "quality"
"""The metric of graded quality."""


def final_mask(episode: Episode) -> NDArray[np.bool_]:
    """The cloth in the last picture, bool, shape (H, W); empty if it was carried out of sight.

    It is segmented as well as can be: noise that was injected into masks to fold by is none of the result's.
    """
    return _cloth(episode, episode.final)


def first_mask(episode: Episode) -> NDArray[np.bool_]:
    """The flat cloth in the first picture, bool, shape (H, W); empty if the segmenter finds none."""
    return _cloth(episode, episode.start)


def _cloth(episode: Episode, seen: Observation) -> NDArray[np.bool_]:
    chosen = undisturbed("segmenters", episode.experiment.segmenter)
    try:
        return plugins.create("segmenters", chosen.name, chosen.params).segment(seen)
    except GroundingError:
        return np.zeros(seen.depth.shape, bool)


def judge(episode: Episode, asked_for: str | Task | None = None) -> Episode:
    """The episode with its fidelity.

    Args:
        episode: what happened.
        asked_for: the task that the caller names, or its id among the installed suites.

    The ideal lines come from the true keypoints and the task that is named, else the task one of whose own sentences
    was said, else the one that the plan is recognised as; else they are the planned lines. The fidelity says which
    (:class:`polyfold.types.Fidelity`). Of real cloth only outlines are compared.
    """
    if not episode.initial_state.known:
        return _outlined(episode)
    kind = episode.garment.kind
    tasks = known_tasks(kind)
    asked = [task for task in tasks if _plain(episode.instruction) in map(_plain, task.instructions)]
    if asked_for is not None:
        named = asked_for if isinstance(asked_for, Task) else find_task(asked_for, kind)
        judged = _beside(episode, named, "task")
        return judged if not asked or named.id in (task.id for task in asked) else _doubted(judged, asked[0])
    if asked:
        # A sentence may ask for several tasks alike, such as those that differ in what goes first.
        judged = [_beside(episode, task, "sentence") for task in asked]
        return min(judged, key=_rank)
    if not episode.steps:
        return episode
    planned = [step.fold_line for step in episode.final_attempts() if step.fold_line is not None]
    recognised = recognise(tasks, episode.initial_state.keypoint_pixels(), planned)
    if recognised is not None:
        return _beside(episode, find_task(recognised, kind), "recognised")
    return _compared(episode, planned, "self-referenced")


def _outlined(episode: Episode) -> Episode:
    """The episode with its last outline compared with the first one, folded along the planned lines."""
    lines = [step.fold_line for step in episode.final_attempts() if step.fold_line is not None]
    if not lines:
        return episode
    found = Fidelity(iou(final_mask(episode), _outline_along(episode, lines)), math.nan, 0, "outline")
    return replace(episode, fidelity=found, ideal_lines=tuple(lines))


def _outline_along(episode: Episode, lines: Sequence[FoldLine]) -> NDArray[np.bool_]:
    """The first outline folded along lines, bool, shape (H, W): each mirrors what lies left of it."""
    mask = first_mask(episode)
    rows, columns = np.indices(mask.shape)
    pixels = np.stack([columns, rows], axis=-1).astype(float)
    for line in lines:
        lifted = line.lifts(pixels)
        column, row = np.rint(line.mirror(pixels)).astype(int).transpose(2, 0, 1)
        inside = (row >= 0) & (row < mask.shape[0]) & (column >= 0) & (column < mask.shape[1])
        came = np.zeros_like(mask)
        came[inside] = (mask & lifted)[row[inside], column[inside]]
        mask = (mask & ~lifted) | came
    return mask


def _doubted(episode: Episode, asked: Task) -> Episode:
    """The episode without a verdict, since its sentence asks for another task than the caller named."""
    assert episode.fidelity is not None
    return replace(episode, fidelity=replace(episode.fidelity, verdict=None, contradicted=asked.id))


def _plain(sentence: str) -> str:
    """A sentence without what makes no difference: case, spaces, punctuation, American spelling."""
    words = "".join(sign if sign.isalnum() else " " for sign in sentence.casefold()).split()
    return " ".join("centre" if word == "center" else word for word in words)


def _rank(episode: Episode) -> tuple[int, float]:
    """Sorts judged episodes, the best first."""
    assert episode.fidelity is not None
    verdicts = [verdict for verdict, *_ in VERDICTS]
    verdict = episode.fidelity.verdict
    return verdicts.index(verdict) if verdict in verdicts else len(verdicts), -episode.fidelity.iou


def _beside(episode: Episode, task: Task, reference: Reference) -> Episode:
    lines = fold_lines(task, episode.initial_state.keypoint_pixels())
    return replace(_compared(episode, lines, reference), task=task.id)


def _compared(episode: Episode, lines: Sequence[FoldLine], reference: Reference) -> Episode:
    """The episode beside the flat garment folded ideally along lines."""
    mask, flat, mesh = final_mask(episode), episode.initial_state, episode.garment.mesh
    folded = fold_ideally(flat, episode.garment, lines)
    found = fidelity(mask, episode.final_state, flat, folded, reference)
    ideal = folded.outcome(flat, mesh)
    end = Outcome(flat, episode.final_state, mask, mesh)
    quality = _quality(end, ideal)
    found = replace(found, verdict=_verdict(end, ideal, quality), quality=quality)
    return replace(episode, fidelity=found, ideal_lines=tuple(lines))


def _verdict(end: Outcome, ideal: Outcome, quality: float) -> Verdict | None:
    """The best verdict that the end earns; None where a criterion is not installed."""
    known = plugins.names("criteria")
    if any(name not in known for _, name, _ in VERDICTS):
        return None
    for verdict, name, least in VERDICTS:
        if quality < least:  # it is NaN only where nobody installed the metric
            continue
        bounds = criteria([name])[name]
        if succeeded({bound.metric: _value(bound.metric, end, ideal) for bound in bounds}, bounds):
            return verdict
    return "bad"


def _quality(end: Outcome, ideal: Outcome) -> float:
    return _value(QUALITY, end, ideal) if QUALITY in plugins.names("metrics") else math.nan


def _value(metric: str, end: Outcome, ideal: Outcome) -> float:
    return plugins.create("metrics", metric).score(end, [ideal])
