"""Episodes as plain data: what ``episode.json`` and ``polyfold fold --json`` contain."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from polyfold.logs._run_directory import SCHEMA_VERSION, versions
from polyfold.types import Episode, Step
from polyfold.types._views import makes


@makes(Episode, "summary")
def summary(episode: Episode) -> dict[str, Any]:
    """The episode without its pictures and states; pixels rounded to tenths, seconds to milliseconds."""
    failure, fidelity = episode.failure, episode.fidelity
    return {
        "schema_version": SCHEMA_VERSION,
        "instruction": episode.instruction,
        "garment": {"kind": episode.garment.kind, "name": episode.garment.name},
        "seed": episode.seed,
        "task": episode.task,
        "agent": episode.experiment.agent.name,
        "privileged": episode.privileged,
        "subgoals": [subgoal.text for subgoal in episode.subgoals],
        "steps": [_step(step) for step in episode.steps],
        "seconds": _seconds(episode.seconds),
        "fidelity": None
        if fidelity is None
        else {
            "iou": round(fidelity.iou, 4),
            "moved_part_error_mm": _number(fidelity.moved_part_error_mm),
            "reference": fidelity.reference,
        },
        "failure": None if failure is None else {"stage": failure.stage, "reason": failure.reason},
        "experiment": episode.experiment.model_dump(),
        "versions": versions(),
    }


def _step(step: Step) -> dict[str, Any]:
    line = step.fold_line
    return {
        "subgoal": step.subgoal.text if step.subgoal else None,
        "fold_line": {"start": _pixels(line.start), "end": _pixels(line.end)} if line else None,
        "picks": _pixels(step.action.picks),
        "places": _pixels(step.action.places),
        "seconds": _seconds(step.seconds),
        "notes": list(step.scene.notes) if step.scene else [],
        "retry": step.retry,
    }


def _pixels(points: Any) -> Any:
    return np.round(np.asarray(points, float), 1).tolist()


def _seconds(seconds: dict[str, float]) -> dict[str, float]:
    return {stage: round(spent, 3) for stage, spent in seconds.items()}


def _number(value: float) -> float | None:
    """JSON has no NaN: a value that does not exist is null."""
    return round(value, 2) if math.isfinite(value) else None
