"""``polyfold tasks``: the installed task suites, and what is in them."""

from __future__ import annotations

import argparse

from polyfold import plugins
from polyfold.errors import PolyfoldError


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("suite", nargs="?", metavar="SUITE", help="list its tasks and goals (default: list the suites)")
    parser.add_argument("--garment", metavar="KIND", help="only this kind")


def run(arguments: argparse.Namespace) -> int:
    """Print the list."""
    if arguments.suite is None:
        _list_suites()
    else:
        _list_tasks(arguments.suite, arguments.garment)
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


def _list_tasks(name: str, kind: str | None) -> None:
    from polyfold.evaluation import suite
    from polyfold.tasks._words import describe

    found = suite(name)
    for task in found.tasks:
        if kind in (None, task.garment):
            folds = "; ".join(describe(fold) for fold in task.steps)
            print(f"{task.id}  [{task.type}{', ' + task.split if task.split else ''}]\n    {folds}")
    for goal in found.goals:
        if kind in (None, goal.garment):
            print(f"{goal.id}  [{goal.type}]\n    {goal.text}")
