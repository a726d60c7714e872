"""The typed log: what is kept of runs, episodes, steps and calls, as pydantic models with a schema version.

Values that are plain already (:class:`polyfold.types.Reply`, ``Failure``, ``Threshold``) stand in them as they are.
Everything that is shown of a run (tables, reports, pictures of results) is read from these records and from nothing
else. A file of an unknown schema version is refused, never guessed at.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from polyfold.config import ComponentSpec, Experiment
from polyfold.logs._accounts import Account, accounts
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._host import HostRecord
from polyfold.types import Failure, Reply, Threshold

SCHEMA_VERSION = 2
"""Of the log's files. Version 1 is read too (:mod:`polyfold.logs._schema_1`)."""

Pixel = tuple[float, float]
"""x and y [px], y down."""


class LogRecord(BaseModel):
    """Base of the log's records: frozen; unknown fields are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class FoldLineRecord(LogRecord):
    """A directed fold line [px]; the cloth on its left was lifted."""

    start: Pixel
    end: Pixel


class StepRecord(LogRecord):
    """One executed fold.

    Attributes:
        subgoal: the step in words, if the agent had any.
        fold_line: the line behind the action, if there was one.
        picks, places: one pixel an arm [px].
        seconds: time per stage [s].
        notes: what grounding had to say about the picture.
        retry: whether it repeats the fold before, which was seen to have failed.
        values_picks: whether the policy rated every place to pick.
        grasped: how many plies each arm held, 0 for an empty grip; None if the simulator doesn't say.
        short: how far from its place each arm stopped because the cloth reached no farther [m]; None likewise.
        slipped: what share of the cloth that each arm held slipped out of its grip, 0 to 1; None likewise.
    """

    subgoal: str | None
    fold_line: FoldLineRecord | None
    picks: tuple[Pixel, ...]
    places: tuple[Pixel, ...]
    seconds: dict[str, float]
    notes: tuple[str, ...] = ()
    retry: bool = False
    values_picks: bool = False
    grasped: tuple[int, ...] | None = None
    short: tuple[float, ...] | None = None
    slipped: tuple[float, ...] | None = None


class CallRecord(LogRecord):
    """One request to a language model; see :class:`polyfold.types.Call`.

    Attributes:
        messages: what was sent, each picture as its SHA-256 and length; None where a log keeps only their digest.
        messages_sha256: digest of the messages as JSON.
    """

    role: str
    step: int | None
    attempt: int
    params: dict[str, Any]
    messages: tuple[dict[str, Any], ...] | None
    messages_sha256: str
    reply: Reply | None = None
    error: str | None = None
    rejected: str | None = None


class FidelityRecord(LogRecord):
    """How near the end is to the ideal fold; see :class:`polyfold.types.Fidelity`."""

    iou: float
    moved_part_error_mm: float | None
    reference: str
    verdict: str | None = None
    quality: float | None = None


class FabricRecord(LogRecord):
    """What a garment was made of.

    Attributes:
        name: of the fabric.
        constants: by name, in SI units; see :class:`polyfold.garments.Fabric`.
    """

    name: str
    constants: dict[str, float]


class GarmentRecord(LogRecord):
    """What lay on the table.

    Attributes:
        kind: kind of garment.
        name: the instance.
        seed: what it was generated from; None for meshes and twins of real garments.
        size_m: longest side of the flat garment's bounding box [m].
        particles: vertices of its mesh.
        fabric: what it was made of; None in logs from before garments had one.
    """

    kind: str
    name: str
    seed: int | None
    size_m: float | None
    particles: int | None
    fabric: FabricRecord | None = None


class EpisodeRecord(LogRecord):
    """One episode: what was asked, what was done, how it ended.

    Attributes:
        instruction: the sentence.
        garment: what lay on the table.
        pose_seed: decides how it lay.
        agent_seed: decides the agent's random choices.
        task: what it was judged as, if that is known.
        agent: name of the agent.
        privileged: whether the agent saw more than a camera does.
        subgoals: the sentence's decomposition.
        steps: every fold, repeated ones included.
        calls: every request to the language model.
        failure: why it ended early; None if it did not.
        fidelity: against the ideal fold; None where that was not asked for.
        seconds: time per stage, summed over the steps [s].
        started, finished: when, in UTC.
        processor: what it ran on.
    """

    schema_version: Literal[2] = SCHEMA_VERSION
    instruction: str
    garment: GarmentRecord
    pose_seed: int
    agent_seed: int | None
    task: str | None
    agent: str
    privileged: bool
    subgoals: tuple[str, ...]
    steps: tuple[StepRecord, ...]
    calls: tuple[CallRecord, ...] = ()
    failure: Failure | None
    fidelity: FidelityRecord | None = None
    seconds: dict[str, float]
    started: datetime | None
    finished: datetime | None
    processor: str | None

    @property
    def folds(self) -> int:
        """Folds that were planned and done, each counted once however often it was tried."""
        return sum(not step.retry for step in self.steps)

    @property
    def retries(self) -> int:
        """Folds that repeat the one before."""
        return sum(step.retry for step in self.steps)

    @property
    def values_picks(self) -> bool:
        """Whether a policy said of some fold how good it takes every place to pick for."""
        return any(step.values_picks for step in self.steps)

    @property
    def unanswered(self) -> bool:
        """Whether it ended because its language model gave no answer, which may go better another time."""
        return self.failure is not None and self.failure.stage == "unanswered"

    @property
    def language(self) -> Mapping[str, Account]:
        """What each role of the language model took, counted from the calls."""
        return accounts(self.calls)


class KeyedRecord(LogRecord):
    """A record that is stored one per line in a run directory.

    Attributes:
        key: unique within the run.
    """

    key: str


class FoldRecord(EpisodeRecord):
    """A single fold, as ``episode.json`` holds it: the episode with all that it depends on."""

    experiment: Experiment
    fingerprint: Fingerprint
    host: HostRecord
    out: str | None = None


class BoundsRecord(LogRecord):
    """Whether an end keeps a goal's own bounds.

    Attributes:
        holds: whether it keeps all of them.
        failing: names of those that it does not.
        measured: the quantities that bounds are about (:class:`polyfold.tasks.Measured`).
    """

    holds: bool
    failing: tuple[str, ...]
    measured: dict[str, bool | int | float]


class StudyEpisodeRecord(KeyedRecord, EpisodeRecord):
    """One episode of a study, scored.

    Attributes:
        variant: the study's variant.
        factors: what tells the variant from the others of its grid, by setting.
        type, split: of the task; see :class:`polyfold.tasks.Task`.
        steps_wanted: folds of the task; None for goals that leave them open.
        wording: which of the task's sentences was used.
        wording_unseen: whether no part of the project was ever tuned on sentences like it; None where the suite
            doesn't say.
        metrics: value by name, in the unit that the run's record names; None where there was nothing to measure.
        done: what a goal's own bounds say about the end; None where it has none.
        recorded_language: accounts of the language model in runs of schema version 1, which kept no calls.
        recorded_folds: folds and repeats in runs of schema version 1, which kept no steps.
        step_errors_mm: mean particle error after each of the episode's own folds [mm].
        success: by criterion.
        cause: the first cause of a failure by the study's first criterion; None for successes.
        reference_idle: whether the reference moved nothing, so that doing nothing is right.
        peak_memory_mb: largest memory, up to then, of the process that ran it [MiB].
        picture: path of its picture within the run directory.
    """

    variant: str
    factors: dict[str, str] = Field(default_factory=dict)
    type: str
    split: str | None
    steps_wanted: int | None
    wording: int
    wording_unseen: bool | None = None
    metrics: dict[str, float | None]
    done: BoundsRecord | None = None
    step_errors_mm: tuple[float | None, ...] = ()
    success: dict[str, bool]
    cause: str | None
    reference_idle: bool = False
    peak_memory_mb: float | None
    picture: str | None = None
    recorded_language: dict[str, Account] | None = None
    recorded_folds: tuple[int, int] | None = None

    @property
    def folds(self) -> int:
        """Folds that were planned and done, each counted once however often it was tried."""
        return super().folds if self.recorded_folds is None else self.recorded_folds[0]

    @property
    def retries(self) -> int:
        """Folds that repeat the one before."""
        return super().retries if self.recorded_folds is None else self.recorded_folds[1]

    @property
    def language(self) -> Mapping[str, Account]:
        """What each role of the language model took."""
        return super().language if self.recorded_language is None else self.recorded_language

    @property
    def succeeded(self) -> bool:
        """Whether it met the study's own criterion, the first."""
        return next(iter(self.success.values()))

    @property
    def compared(self) -> bool:
        """Whether there was anything to compare with: goals that accept no task have no metrics."""
        return any(value is not None for value in self.metrics.values())


class MetricRecord(LogRecord):
    """How a metric is shown.

    Attributes:
        label: heading without the unit.
        unit: ``mm``, for example; empty if it has none.
        digits: after the point.
        higher_is_better: which way is good.
        summary: what it measures, in words.
        most: the largest value that there can be, which no interval passes; None if there is none.
    """

    label: str
    unit: str
    digits: int
    higher_is_better: bool
    summary: str = ""
    most: float | None = None

    @property
    def heading(self) -> str:
        """Label with the unit, as columns are headed."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label


class ChangeRecord(LogRecord):
    """A run that went on knowingly although what it depends on had changed.

    Attributes:
        when: in UTC.
        differences: what had changed, in words.
        fingerprint: what it went on with.
        components: as in :class:`RunRecord`, then.
        episodes: how many were finished before.
    """

    when: datetime
    differences: tuple[str, ...]
    fingerprint: Fingerprint
    components: dict[str, dict[str, ComponentSpec]] = Field(default_factory=dict)
    episodes: int


class RunRecord(LogRecord):
    """A run: what was asked, and what its results depend on.

    Attributes:
        asked: what was asked for, defaults included, as plain data.
        components: by variant and field of its experiment, the components in use at first, their defaults included.
        started: when, in UTC.
        fingerprint: code, prompts and weights that it began with; see ``changes``.
        host: where it began.
        metrics: how each metric is shown.
        criteria: bounds of each success criterion; the first is the study's own.
        changes: when it went on with something else.
    """

    schema_version: Literal[2] = SCHEMA_VERSION
    asked: dict[str, Any]
    components: dict[str, dict[str, ComponentSpec]] = Field(default_factory=dict)
    started: datetime | None
    fingerprint: Fingerprint | None
    host: HostRecord | None
    metrics: dict[str, MetricRecord] = Field(default_factory=dict)
    criteria: dict[str, tuple[Threshold, ...]] = Field(default_factory=dict)
    changes: tuple[ChangeRecord, ...] = ()
