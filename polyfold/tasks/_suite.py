"""Folding tasks as data: a suite file names, for every task, its folds on the flat garment's keypoints.

A goal that leaves the folds open is a ``[[goal]]`` instead of a ``[[task]]``; :class:`polyfold.tasks.OpenTask`
describes it. A suite may hold both.

A suite is a TOML file::

    schema_version = 1
    name = "my-suite"

    [points.square]                       # optional: names for points between keypoints
    center = { bottom_left = 0.25, top_left = 0.25, top_right = 0.25, bottom_right = 0.25 }

    [[task]]
    id = "square-corner-top_left"
    garment = "square"
    type = "S-Corner"
    steps = [{ pairs = [["top_left", "center"]] }]

A step is one fold. ``pairs`` says which points come to lie on which: the fold line is the mirror line that does it
best, and the first point of each pair is on the lifted side. ``crease`` gives two points of the line instead, and
``lift`` a point on the lifted side. All points are those of the flat garment: a fold leaves the rest where it is.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from polyfold.errors import ConfigError, did_you_mean, validation_problem
from polyfold.errors._hints import toml_problem
from polyfold.tasks._goals import OpenTask
from polyfold.tasks._words import as_table, listed, moves_in_words, sentences_in_words


def _as_weights(value: Any) -> Any:
    return {value: 1.0} if isinstance(value, str) else value


Point = Annotated[dict[str, float], BeforeValidator(_as_weights)]
"""A point of the flat garment: keypoint name -> weight, weights summing to 1; in TOML a bare name will do."""


class Fold(BaseModel):
    """One fold: either ``pairs``, or ``crease`` and ``lift``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pairs: tuple[tuple[Point, Point], ...] | None = Field(None, min_length=1)
    crease: tuple[Point, Point] | None = None
    lift: Point | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Fold:
        if (self.pairs is None) == (self.crease is None) or (self.crease is None) != (self.lift is None):
            raise ValueError("a step has either 'pairs', or 'crease' with 'lift'; give exactly one of the two")
        for point in self.points():
            if not point or abs(sum(point.values()) - 1.0) > 0.01:
                raise ValueError(f"the weights of a point must sum to 1, got {point}; correct them")
        return self

    def points(self) -> list[dict[str, float]]:
        """Every point that it names."""
        if self.pairs is not None:
            return [point for pair in self.pairs for point in pair]
        return [*(self.crease or ()), self.lift or {}]

    def in_words(self) -> str:
        """What is folded onto what, by the names of the points."""
        return moves_in_words(self.pairs, self.crease, self.lift)


class Task(BaseModel):
    """A goal that can be judged: the folds that reach it on a garment of one kind.

    Attributes:
        id: unique name within its suite.
        garment: garment kind.
        type: the family it belongs to, such as ``S-Corner``.
        steps: the folds, in order.
        instructions: sentences that ask for it, all meaning the same.
        split: whether learning baselines may train on it (``seen``) or not (``unseen``); None where nobody decided.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str = Field(pattern=r"^[a-z0-9_-]+$", max_length=80)
    garment: str
    type: str
    steps: tuple[Fold, ...] = Field(min_length=1)
    instructions: tuple[str, ...] = ()
    split: Literal["seen", "unseen"] | None = None

    def points(self) -> set[str]:
        """The keypoints that its folds go by."""
        return {name for fold in self.steps for point in fold.points() for name in point}


class Suite(BaseModel):
    """A named list of tasks, of open tasks, or of both.

    Attributes:
        name: what it is called in messages.
        description: one line.
        accept_from: name of the registered suite whose tasks the goals accept; its own name for its own tasks.
        unseen_wordings: positions among each task's instructions of those that no part of the project was ever tuned
            on; None where nobody says.
        tasks: the tasks with given folds (``[[task]]``).
        goals: the open tasks (``[[goal]]``).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1]
    name: str
    description: str = ""
    accept_from: str = "polyfold70"
    unseen_wordings: frozenset[int] | None = None
    tasks: tuple[Task, ...] = Field((), alias="task")
    goals: tuple[OpenTask, ...] = Field((), alias="goal")

    @model_validator(mode="before")
    @classmethod
    def _with_named_points(cls, suite: Any) -> Any:
        """Put the weights in place of the points that the suite itself names."""
        if not isinstance(suite, dict) or not isinstance(suite.get("points", {}), dict):
            return suite
        points = suite.get("points", {})
        suite = {key: value for key, value in suite.items() if key != "points"}
        if isinstance(suite.get("task"), list):
            suite["task"] = [_substituted(task, points) for task in suite["task"]]
        return suite

    @model_validator(mode="after")
    def _something_with_unique_ids(self) -> Suite:
        if not self.entries:
            raise ValueError("the suite is empty; give a [[task]] or a [[goal]]")
        times = Counter(entry.id for entry in self.entries)
        for entry_id, count in times.items():
            if count > 1:
                raise ValueError(f"the id {entry_id!r} is used twice; rename one")
        return self

    @property
    def entries(self) -> tuple[Task | OpenTask, ...]:
        """All that can be asked for: the tasks, then the open tasks."""
        return (*self.tasks, *self.goals)

    def task(self, task_id: str) -> Task:
        """The task of this id. Raises ConfigError with the nearest ids when there is none."""
        return _of_id(self.tasks, task_id, self.name)

    def entry(self, entry_id: str) -> Task | OpenTask:
        """The task or open task of this id. Raises ConfigError with the nearest ids when there is none."""
        return _of_id(self.entries, entry_id, self.name)

    def matching(self, patterns: Sequence[str]) -> tuple[Task | OpenTask, ...]:
        """The entries whose ids match one of the patterns, such as ``square-corner-*``.

        Raises:
            ConfigError: with the nearest ids, if a pattern matches none.
        """
        for pattern in patterns:
            if not any(fnmatch(entry.id, pattern) for entry in self.entries):
                hint = did_you_mean(pattern, [entry.id for entry in self.entries])
                raise ConfigError(f"no task of {self.name!r} matches {pattern!r}; {hint}")
        return tuple(entry for entry in self.entries if any(fnmatch(entry.id, pattern) for pattern in patterns))

    def for_garment(self, kind: str) -> tuple[Task, ...]:
        """The tasks on garments of this garment kind."""
        return tuple(task for task in self.tasks if task.garment == kind)

    def only(self, kind: str) -> Suite:
        """What of it is for garments of one garment kind. Raises ConfigError with the nearest kinds if nothing is."""
        kinds = sorted({entry.garment for entry in self.entries})
        if kind not in kinds:
            raise ConfigError(f"the suite {self.name} has nothing for a {kind!r}; {did_you_mean(kind, kinds)}")
        goals = tuple(goal for goal in self.goals if goal.garment == kind)
        return self.model_copy(update={"tasks": self.for_garment(kind), "goals": goals})

    def in_words(self) -> str:
        """Every task with a sentence that asks for it and its folds, then the goals; several lines each."""
        return listed(self._rows())

    def _rows(self) -> list[tuple[str, str, str, list[str]]]:
        rows = [
            (
                task.id,
                ", ".join(filter(None, (task.type, task.split))),
                sentences_in_words(task.instructions),
                [fold.in_words() for fold in task.steps],
            )
            for task in self.tasks
        ]
        return [
            *rows,
            *((goal.id, goal.type, sentences_in_words(goal.instructions), [goal.in_words()]) for goal in self.goals),
        ]

    def _repr_html_(self) -> str:
        return as_table(self._rows())


_Entry = TypeVar("_Entry", bound="Task | OpenTask")


def _of_id(entries: Sequence[_Entry], entry_id: str, suite: str) -> _Entry:
    for entry in entries:
        if entry.id == entry_id:
            return entry
    hint = did_you_mean(entry_id, (entry.id for entry in entries))
    raise ConfigError(f"the suite {suite} has no task {entry_id!r}; {hint}")


def is_file(suite: str) -> bool:
    """Whether a suite is named by its file, not by its registered name."""
    return suite.endswith(".toml")


def load_suite(source: str | Path) -> Suite:
    """Read a suite from a path, or from ``"package:path/within/it.toml"`` as plugins register it.

    Raises:
        ConfigError: naming the file, the task or goal and the field that is wrong.
    """
    where, text = _read(source)
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{where} {toml_problem(error, text)}") from error
    try:
        return Suite.model_validate(content)
    except ValidationError as error:
        raise ConfigError(f"{where}: {_first_problem(error, content)}") from error


def _substituted(task: Any, points: Mapping[str, Any]) -> Any:
    """A raw task with its garment's named points replaced by their weights."""
    if not isinstance(task, dict):
        return task
    named = points.get(str(task.get("garment")), {})

    def replaced(value: Any) -> Any:
        if isinstance(value, str):
            return named.get(value, value)
        return [replaced(item) for item in value] if isinstance(value, list) else value

    if not named or not isinstance(task.get("steps"), list):
        return task
    steps = [
        {key: replaced(value) for key, value in step.items()} if isinstance(step, dict) else step
        for step in task["steps"]
    ]
    return {**task, "steps": steps}


def _read(source: str | Path) -> tuple[str, str]:
    """What to call the source in messages, and its text."""
    try:
        if isinstance(source, str) and ":" in source and not Path(source).exists():
            package, _, path = source.partition(":")
            return source, files(package).joinpath(path).read_text("utf-8")
        return str(source), Path(source).read_text("utf-8")
    except (FileNotFoundError, ModuleNotFoundError) as error:
        raise ConfigError(f"there is no task suite {source}; check the path") from error
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"the task suite {source} can't be read ({error}); save it as UTF-8 text") from error


def _first_problem(error: ValidationError, content: Mapping[str, Any]) -> str:
    """The first validation problem as one sentence with the task or goal and the field."""
    place = error.errors()[0]["loc"]
    if len(place) < 2 or place[0] not in ("task", "goal"):
        return f"the suite {validation_problem(error)} (see polyfold.tasks for the format)"
    kind, number = place[:2]
    entry = content[str(kind)][number]
    name = entry.get("id", f"number {int(number) + 1}") if isinstance(entry, dict) else f"number {int(number) + 1}"
    return f"{kind} {name} {validation_problem(error, below=2)} (see polyfold.tasks for the format)"
