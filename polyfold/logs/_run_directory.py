"""Run directories: append-only, one finished episode a line, safe to kill at any moment and to resume.

``run.json`` says what the run is (:class:`RunRecord`); ``episodes.jsonl`` holds one finished episode a line, appended
and flushed to disk. A last line that a kill cut in half is dropped when the directory is opened again. A line that is
damaged is set aside, of which is warned, and its episode runs again.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from polyfold.config import ComponentSpec
from polyfold.errors import ConfigError, validation_problem
from polyfold.errors._hints import file_problem
from polyfold.logs import _schema_1
from polyfold.logs._disk.files import write_atomically
from polyfold.logs._disk.json_lines import Damage, JsonLines
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._host import this_host
from polyfold.logs._records import (
    SCHEMA_VERSION,
    ChangeRecord,
    KeyedRecord,
    MetricRecord,
    RunRecord,
    StudyEpisodeRecord,
)
from polyfold.types import Threshold

Record = TypeVar("Record", bound=KeyedRecord)
Model = TypeVar("Model", bound=BaseModel)

DESCRIPTION, EPISODES = "run.json", "episodes.jsonl"


class RunDirectory(Generic[Record]):
    """A directory of results that belong to one configuration, for its only writer (:func:`exclusive`).

    Args:
        path: the directory; created if needed.
        asked: plain data that defines the run; a directory made with another one is refused.
        record_type: the model of its records.
        fingerprint: what results depend on besides; see :meth:`guard`.
        metrics: how each metric is shown.
        criteria: bounds of each success criterion, the run's own first.
        components: by variant and field of its experiment, the components in use, their defaults included.
        extends: whether what is asked now, its second argument, is what was asked before, its first, and more; the
            directory is gone on with then.
        redescribe: take the directory for this configuration's although its description is damaged, which is kept
            beside the new one.

    Raises:
        ConfigError: if the directory belongs to another configuration or another schema version, or lacks its
            description.
    """

    def __init__(
        self,
        path: str | Path,
        asked: Mapping[str, Any],
        record_type: type[Record],
        fingerprint: Fingerprint | None = None,
        metrics: Mapping[str, MetricRecord] | None = None,
        criteria: Mapping[str, tuple[Threshold, ...]] | None = None,
        components: Mapping[str, dict[str, ComponentSpec]] | None = None,
        extends: Callable[[Mapping[str, Any], Mapping[str, Any]], bool] = lambda before, now: False,
        redescribe: bool = False,
    ) -> None:
        self.path = Path(path)
        self.path.mkdir(parents=True, exist_ok=True)
        self._record_type = record_type
        self._lines = JsonLines(self.path / EPISODES)
        plain: dict[str, Any] = json.loads(json.dumps(asked))
        self._now = RunRecord(
            asked=plain,
            components=dict(components or {}),
            started=datetime.now(UTC),
            fingerprint=fingerprint,
            host=this_host(),
            metrics=dict(metrics or {}),
            criteria=dict(criteria or {}),
        )
        if (self.path / DESCRIPTION).exists():
            self.run = self._claimed(redescribe)
        elif (self.path / EPISODES).exists():
            raise ConfigError(
                f"{self.path} holds {EPISODES} but no {DESCRIPTION}, so that nobody can tell what made its episodes; "
                f"put {DESCRIPTION} back, or use another directory"
            )
        else:
            self._describe(self._now)
        self._lines.repair()
        self._set_damage_aside()
        self._grown = self.run.asked != plain and bool(self._lines.read()) and extends(self.run.asked, plain)
        if self.run.asked != plain and not self._grown:
            self._replace()

    def _replace(self) -> None:
        """Describe this run in place of one of another configuration, if that has no episode yet.

        A run that ended before its first one, for want of a key, say, binds nobody.
        """
        if self._lines.read():
            changed = "; ".join(_changes(self.run.asked, self._now.asked))
            raise ConfigError(
                f"{self.path} holds a run with another configuration ({changed}); "
                "use another directory, or the old configuration"
            )
        self._describe(self._now)

    def _set_damage_aside(self) -> None:
        _, damaged = self._lines.sound(self._parse)
        if damaged:
            beside = self._lines.set_aside(damaged)
            _warn_of(damaged, f"set aside in {beside.name}, and such an episode runs again")

    def _parse(self, content: Mapping[str, Any], where: str) -> Record:
        return _validated(self._record_type, content, where)

    def _claimed(self, redescribe: bool) -> RunRecord:
        try:
            if _content(self.path / DESCRIPTION).get("schema_version") == _schema_1.SCHEMA_VERSION:
                raise ConfigError(
                    f"{self.path} holds a run of an older version, which can be read and no longer resumed; "
                    "use another directory"
                )
            return read_run(self.path)
        except _DamagedError as error:
            if not redescribe:
                raise
            return self._described_anew(error)

    def _described_anew(self, error: _DamagedError) -> RunRecord:
        kept = self.path / "run.damaged.json"
        (self.path / DESCRIPTION).replace(kept)
        warnings.warn(f"{error.problem}: it is kept as {kept.name} and the run is described anew", stacklevel=4)
        change = ChangeRecord(
            when=datetime.now(UTC),
            differences=(f"{DESCRIPTION} was damaged and was written anew",),
            fingerprint=self._now.fingerprint or Fingerprint(),
            components=self._now.components,
            episodes=sum(1 for _ in self._lines.lines()),
        )
        self._describe(self._now.model_copy(update={"changes": (change,)}))
        return self.run

    def _describe(self, run: RunRecord) -> None:
        self.run = run
        write_atomically(self.path / DESCRIPTION, run.model_dump_json(indent=2) + "\n")

    def guard(self, accept_change: bool = False) -> None:
        """Make sure that what is added now is made by what made the rest, as fingerprints tell.

        Args:
            accept_change: go on although the fingerprint differs from the run's; that is recorded.

        Raises:
            ConfigError: if it differs, with the difference.
        """
        finished = len(self.records())
        if not finished:
            self._describe(self._now)
            return
        now = self._now.fingerprint or Fingerprint()
        before = (self.run.changes[-1].fingerprint if self.run.changes else self.run.fingerprint) or Fingerprint()
        differences = before.differences(now, with_new=not self._grown)
        if not differences:
            self._ask_for_more()
            return
        if not accept_change:
            raise ConfigError(
                f"{self.path} holds {finished} episodes that were made by something else ({'; '.join(differences)}); "
                "use another directory, or go on knowingly with --accept-change (accept_change=True), "
                "which the run then records"
            )
        change = ChangeRecord(
            when=datetime.now(UTC),
            differences=differences,
            fingerprint=now,
            components=self._now.components,
            episodes=finished,
        )
        self._describe(
            self.run.model_copy(
                update={
                    "changes": (*self.run.changes, change),
                    "metrics": {**self.run.metrics, **self._now.metrics},
                    "criteria": self._now.criteria,
                }
            )
        )
        self._ask_for_more()

    def _ask_for_more(self) -> None:
        """What is finished counts in a run that grew; what the rest depends on besides is noted."""
        if not self._grown:
            return
        components = {**self.run.components, **self._now.components}
        update: dict[str, Any] = {"asked": self._now.asked, "components": components}
        if self.run.changes:
            last = self.run.changes[-1].model_copy(update={"fingerprint": self._now.fingerprint})
            update["changes"] = (*self.run.changes[:-1], last)
        else:
            update["fingerprint"] = self._now.fingerprint
        self._describe(self.run.model_copy(update=update))

    def append(self, record: Record) -> None:
        """Add a finished episode; it is on disk when this returns."""
        self._lines.append(record.model_dump(mode="json"))

    def records(self) -> dict[str, Record]:
        """Finished episodes by key, the last of each, in the order in which their keys first finished."""
        found: dict[str, Record] = {}
        for record in self._lines.sound(self._parse)[0]:
            found[record.key] = record
        return found


def read_run(path: str | Path) -> RunRecord:
    """What a run directory's run is. Raises ConfigError if there is none, or of an unknown schema version."""
    description = Path(path) / DESCRIPTION
    if not description.exists():
        raise ConfigError(f"{path} is no run directory (it has no {DESCRIPTION}); give the --out of an evaluation")
    content = _content(description)
    if content.get("schema_version") == _schema_1.SCHEMA_VERSION:
        return _schema_1.run_record(content)
    if content.get("schema_version") != SCHEMA_VERSION:
        raise ConfigError(
            f"{description} has schema version {content.get('schema_version')}, this is {SCHEMA_VERSION}; "
            "use the polyfold version that made it, or another directory"
        )
    try:
        return RunRecord.model_validate(content)
    except ValidationError as error:
        raise _DamagedError(f"{description} {validation_problem(error)}") from error


def read_episodes(path: str | Path) -> list[StudyEpisodeRecord]:
    """The finished episodes of a study's run directory, the last try of each.

    The directory may be running still: a half-written last line is left out. Damaged lines are, too, with a warning.

    Raises:
        ConfigError: if there is no run directory.
    """
    read_run(path)
    lines = JsonLines(Path(path) / EPISODES)
    old = _content(Path(path) / DESCRIPTION)["schema_version"] == _schema_1.SCHEMA_VERSION
    records, damaged = lines.sound(_old_episode if old else _episode)
    if damaged:
        _warn_of(damaged, "left out; run the evaluation again to have such an episode anew")
    return list({record.key: record for record in records}.values())


def _episode(content: Mapping[str, Any], where: str) -> StudyEpisodeRecord:
    return _validated(StudyEpisodeRecord, content, where)


def _old_episode(content: Mapping[str, Any], where: str) -> StudyEpisodeRecord:
    try:
        return _schema_1.episode_record(content)
    except (KeyError, TypeError, ValueError) as error:
        raise ConfigError(f"{where} is no record of an episode ({error}); remove the line") from error


def _warn_of(damaged: Sequence[Damage], done: str) -> None:
    more = f" and {len(damaged) - 1} more" if len(damaged) > 1 else ""
    warnings.warn(f"{damaged[0].problem}{more}: {done}", stacklevel=4)


def _validated(model: type[Model], content: Mapping[str, Any], where: str) -> Model:
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise ConfigError(f"{where} {validation_problem(error)}") from error


def _content(description: Path) -> dict[str, Any]:
    try:
        content = json.loads(description.read_text("utf-8"))
    except OSError as error:
        raise ConfigError(file_problem(error, description)) from error
    except (ValueError, RecursionError) as error:
        raise _DamagedError(f"{description} is not JSON ({error})") from error
    if not isinstance(content, dict):
        raise _DamagedError(f"{description} describes no run")
    return content


class _DamagedError(ConfigError):
    """The description of a run can't be read.

    Attributes:
        problem: why, without what to do.
    """

    def __init__(self, problem: str) -> None:
        self.problem = problem
        super().__init__(
            f"{problem}; put it back, or run the same evaluation into it with --accept-change (accept_change=True), "
            "which describes the run anew and keeps the damaged file"
        )


def _changes(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Settings that differ, each by its dotted path."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name in sorted({*old, *new}):
            yield from _changes(old.get(name), new.get(name), f"{place}.{name}" if place else name)
    elif old != new:
        yield f"{place}: {old!r} there, {new!r} here"
