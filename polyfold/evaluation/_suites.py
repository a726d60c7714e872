"""The task suites of the installed plugins."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from polyfold import plugins
from polyfold.errors import ConfigError, PluginError, did_you_mean
from polyfold.plugins._fabrics import garment_template
from polyfold.tasks import OpenTask, Suite, Task, load_suite
from polyfold.tasks._suite import is_file


def suite(name: str) -> Suite:
    """A task suite by its registered name, or by its file, its goals checked against the suite whose tasks they accept.

    Args:
        name: for example ``polyfold70``; or the path of a file, which ends in ``.toml``.

    Raises:
        PluginError: if there is no such suite.
        ConfigError: if its file is wrong.
    """
    return _checked(name, _target(name), _stamp(name))


def _target(name: str) -> str:
    return name if is_file(name) else str(plugins.find("tasks", name).target)


def _stamp(name: str) -> int:
    """Tells a file that was changed since."""
    return Path(name).stat().st_mtime_ns if is_file(name) and Path(name).exists() else 0


def accepted_tasks(name: str, goal: OpenTask) -> tuple[Task, ...]:
    """The tasks whose end states count as reaching a goal of the registered suite ``name``; often none."""
    return _accepted(name, suite(name), goal)


@cache
def _checked(name: str, target: str, stamp: int) -> Suite:
    found = _loaded(target, stamp)
    _check_points(target, found)
    for goal in found.goals:
        _accepted(name, found, goal)
    return found


def _check_points(where: str, found: Suite) -> None:
    """Refuse points that a kind of garment does not have, of the kinds that are installed."""
    kinds = {task.garment for task in found.tasks} & set(plugins.names("garments"))
    known = {kind: garment_template(kind).names for kind in kinds}
    for task in found.tasks:
        for name in sorted(task.points() - set(known.get(task.garment, task.points()))):
            hint = did_you_mean(name, known[task.garment])
            raise ConfigError(f"{where}: task {task.id}: a {task.garment} has no point {name!r}; {hint}")


@cache
def _loaded(target: str, stamp: int) -> Suite:
    return load_suite(target)


def _loaded_by_name(name: str) -> Suite:
    """Without a check of its own goals, so that two suites may accept tasks of each other."""
    return _loaded(_target(name), _stamp(name))


def _accepted(name: str, found: Suite, goal: OpenTask) -> tuple[Task, ...]:
    if not goal.accept:
        return ()
    where = _target(name)
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
    """The tasks of all installed suites for a kind of garment.

    A suite that can't be read is passed over, with a warning and a problem recorded against its plugin.
    """
    found: list[Task] = []
    for name in plugins.names("tasks"):
        try:
            found += suite(name).for_garment(kind)
        except (ConfigError, PluginError) as error:
            plugins.blame("tasks", name, f"its suite {name!r} was passed over: {error}")
    return found


def find_task(task_id: str, kind: str) -> Task:
    """A task by id. Raises ConfigError, naming what is known for the kind, if there is none."""
    tasks = known_tasks(kind)
    for task in tasks:
        if task.id == task_id:
            return task
    hint = did_you_mean(task_id, [task.id for task in tasks])
    raise ConfigError(f"no task for a {kind} is called {task_id!r}; {hint}; see: polyfold tasks")
