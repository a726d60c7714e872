"""Records of what happened: episodes, steps and calls as the log keeps them."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from polyfold.garments import Garment
from polyfold.logs._dependencies import fingerprint
from polyfold.logs._host import processor, this_host
from polyfold.logs._records import (
    CallRecord,
    FabricRecord,
    FidelityRecord,
    FoldLineRecord,
    FoldRecord,
    GarmentRecord,
    Pixel,
    StepRecord,
)
from polyfold.types import Call, Episode, Fidelity, Step
from polyfold.types._views import makes


def fold_record(episode: Episode, started: datetime | None = None, finished: datetime | None = None) -> FoldRecord:
    """The record of a single fold, as ``episode.json`` holds it; pixels rounded to tenths, seconds to milliseconds.

    Args:
        episode: what happened.
        started, finished: when, in UTC.
    """
    return FoldRecord(
        **episode_fields(episode, started, finished),
        task=episode.task,
        fidelity=_fidelity(episode.fidelity),
        experiment=episode.experiment,
        fingerprint=fingerprint([episode.experiment], also=[("garments", episode.garment.kind)]),
        host=this_host(),
    )


@makes(Episode, "summary")
def summary(episode: Episode) -> dict[str, Any]:
    """The record of a single fold as plain data."""
    return fold_record(episode).model_dump(mode="json")


def episode_fields(
    episode: Episode, started: datetime | None, finished: datetime | None, keep_messages: bool = True
) -> dict[str, Any]:
    """The fields that every kind of :class:`EpisodeRecord` takes from an episode.

    Args:
        episode: what happened.
        started, finished: when, in UTC.
        keep_messages: whether calls keep their messages, or their digest alone.
    """
    return {
        "instruction": episode.instruction,
        "garment": _garment(episode.garment),
        "pose_seed": episode.seed,
        "agent_seed": episode.agent_seed,
        "agent": episode.experiment.agent.name,
        "privileged": episode.privileged,
        "subgoals": tuple(subgoal.text for subgoal in episode.subgoals),
        "steps": tuple(_step(step) for step in episode.steps),
        "calls": tuple(call_record(call, keep_messages) for call in episode.calls),
        "failure": episode.failure,
        "seconds": _seconds(episode.seconds),
        "started": started,
        "finished": finished,
        "processor": processor(),
    }


def call_record(call: Call, keep_messages: bool = True) -> CallRecord:
    """The record of a call, with its messages or with their digest alone."""
    messages = [dict(message) for message in call.messages]
    text = json.dumps(messages, ensure_ascii=False, sort_keys=True)
    return CallRecord(
        role=call.role,
        step=call.step,
        attempt=call.attempt,
        params=dict(call.params),
        messages=tuple(messages) if keep_messages else None,
        messages_sha256=hashlib.sha256(text.encode()).hexdigest(),
        reply=call.reply,
        error=call.error,
        rejected=call.rejected,
    )


def transcript_lines(calls: Sequence[Call]) -> str:
    """One call a line, as JSON, as ``transcript.jsonl`` has them."""
    return "".join(call_record(call).model_dump_json() + "\n" for call in calls)


def finite(value: float, digits: int) -> float | None:
    """A rounded number; None for NaN and infinity, which JSON does not have."""
    return round(float(value), digits) if math.isfinite(value) else None


def _garment(garment: Garment) -> GarmentRecord:
    corners = garment.mesh.vertices
    return GarmentRecord(
        kind=garment.kind,
        name=garment.name,
        seed=garment.seed,
        size_m=round(float(np.ptp(corners, axis=0).max()), 4),
        particles=len(corners),
        fabric=FabricRecord(name=garment.fabric.name, constants=garment.fabric.constants()),
    )


def _step(step: Step) -> StepRecord:
    line = step.fold_line
    return StepRecord(
        subgoal=step.subgoal.text if step.subgoal else None,
        fold_line=FoldLineRecord(start=_pixel(line.start), end=_pixel(line.end)) if line else None,
        picks=tuple(_pixel(point) for point in step.action.picks),
        places=tuple(_pixel(point) for point in step.action.places),
        seconds=_seconds(step.seconds),
        notes=tuple(step.scene.notes) if step.scene else (),
        retry=step.retry,
        values_picks=step.action_map is not None,
        grasped=step.after.grasped,
        short=step.after.short,
        slipped=step.after.slipped,
    )


def _fidelity(fidelity: Fidelity | None) -> FidelityRecord | None:
    if fidelity is None:
        return None
    return FidelityRecord(
        iou=round(fidelity.iou, 4),
        moved_part_error_mm=finite(fidelity.moved_part_error_mm, 2),
        reference=fidelity.reference,
        verdict=fidelity.verdict,
        quality=finite(fidelity.quality, 1),
    )


def _pixel(point: ArrayLike) -> Pixel:
    x, y = np.round(np.asarray(point, float), 1).tolist()
    return x, y


def _seconds(seconds: Mapping[str, float]) -> dict[str, float]:
    return {stage: round(spent, 4) for stage, spent in seconds.items()}
