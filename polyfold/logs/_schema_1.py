"""Runs of schema version 1 as records of today: they can be read, tabulated and drawn, and no longer be resumed.

Version 1 kept the success criterion ``lenient`` under the name ``polyfold``, no fingerprint, no time stamps, and of
steps and calls no more than counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from polyfold.logs._accounts import Account
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._records import (
    BoundsRecord,
    GarmentRecord,
    MetricRecord,
    RunRecord,
    StudyEpisodeRecord,
)
from polyfold.types import Failure, Threshold

SCHEMA_VERSION = 1

METRICS = {
    "mppe": MetricRecord(
        label="MPPE", unit="mm", digits=1, higher_is_better=False, summary="mean particle position error"
    ),
    "miou": MetricRecord(label="mIoU", unit="", digits=3, higher_is_better=True, summary="IoU of the silhouettes"),
    "moved-part": MetricRecord(
        label="moved part",
        unit="mm",
        digits=1,
        higher_is_better=False,
        summary="mean error of what the reference moved",
    ),
}
CRITERIA = {
    name: (
        Threshold("miou", overlap, higher_is_better=True),
        Threshold("mppe", particles),
        Threshold("moved-part", moved),
    )
    for name, overlap, particles, moved in (("lenient", 0.80, 30.0, 40.0), ("strict", 0.90, 12.5, 20.0))
}


def run_record(content: Mapping[str, Any]) -> RunRecord:
    """The record of a run from its ``run.json``."""
    return RunRecord(
        asked=content["config"],
        started=None,
        fingerprint=Fingerprint(distributions=content.get("versions", {})),
        host=None,
        metrics=METRICS,
        criteria=CRITERIA,
    )


def episode_record(line: Mapping[str, Any]) -> StudyEpisodeRecord:
    """The record of an episode from its line in ``episodes.jsonl``."""
    done, failure = line.get("done"), line["failure"]
    return StudyEpisodeRecord(
        key=line["key"],
        variant=line["variant"],
        instruction=line["instruction"],
        garment=GarmentRecord(
            kind=line["garment"],
            name=f"{line['garment']}-{line['garment_seed']:04d}",
            seed=line["garment_seed"],
            size_m=None,
            particles=None,
        ),
        pose_seed=line["garment_seed"],
        agent_seed=None,
        task=line["task"],
        agent="",
        privileged=line["privileged"],
        subgoals=tuple(line["subgoals"]),
        steps=(),
        recorded_folds=(line["steps"], line.get("retries", 0)),
        failure=None if failure is None else Failure(stage=failure["stage"], reason=failure["reason"]),
        seconds=line["seconds"],
        started=None,
        finished=None,
        processor=None,
        type=line["type"],
        split=line.get("split"),
        steps_wanted=line.get("steps_wanted"),
        wording=line["wording"],
        metrics=line["metrics"],
        done=None if done is None else BoundsRecord(**done),
        step_errors_mm=tuple(line.get("step_errors_mm", ())),
        success={"lenient": line["success"]["polyfold"], "strict": line["success"]["strict"]},
        cause=line["cause"],
        # The error of the moved part was null only where the reference moved nothing.
        reference_idle=line["metrics"].get("mppe") is not None and line["metrics"].get("moved-part", 0.0) is None,
        peak_memory_mb=line.get("peak_memory_mb"),
        picture=line.get("picture"),
        recorded_language={role: Account(**account) for role, account in line.get("language", {}).items()},
    )
