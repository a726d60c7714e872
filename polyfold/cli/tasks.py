"""``polyfold tasks``: the installed task suites, and what is in them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from polyfold import plugins
from polyfold.errors import ConfigError, PolyfoldError

if TYPE_CHECKING:
    from polyfold.tasks import Suite


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("suite", nargs="?", metavar="SUITE", help="list its tasks and goals (default: list the suites)")
    parser.add_argument("--garment", metavar="KIND", help="only this kind")
    parser.add_argument("--out", type=Path, metavar="PNG", help="draw them too: each fold's line, and the end")


def run(arguments: argparse.Namespace) -> int:
    """Print the list."""
    if arguments.suite is None:
        if arguments.out is not None:
            raise ConfigError(f"--out draws the tasks of one suite; name it: {', '.join(plugins.names('tasks'))}")
        _list_suites()
        return 0
    found = _chosen(arguments.suite, arguments.garment)
    print(found.in_words())
    if arguments.out is not None:
        _draw(arguments.suite, found, arguments.out)
    return 0


def _list_suites() -> None:
    """A suite that can't be read is listed with what is wrong, so that the others are still found."""
    from polyfold.evaluation import suite

    for name in plugins.names("tasks"):
        try:
            found = suite(name)
        except PolyfoldError as error:
            print(f"{name:<16} ! {error}")
            continue
        print(f"{name:<16} {len(found.tasks):>4} tasks {len(found.goals):>4} goals   {found.description}")


def _chosen(name: str, kind: str | None) -> Suite:
    """The suite, or what of it is for one kind of garment."""
    from polyfold.evaluation import suite

    found = suite(name)
    return found if kind is None else found.only(kind)


def _draw(name: str, found: Suite, path: Path) -> None:
    from polyfold import viz
    from polyfold.evaluation._suites import accepted_tasks
    from polyfold.viz._tasks import task_sheet

    goals = [(goal, accepted_tasks(name, goal)) for goal in found.goals]
    print(f"pictures: {viz.save(task_sheet(found.tasks, goals, found.name), path)}")
