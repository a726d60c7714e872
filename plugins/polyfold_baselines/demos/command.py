"""``polyfold demos``: demonstrate folds for baselines to learn from, and show what a folder of them holds."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.errors import ConfigError, validation_problem

if TYPE_CHECKING:
    from polyfold_baselines.demos.demonstrating import DemoPlan


class Demos:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument("--arms", type=int, choices=(1, 2), default=2, help="default: 2")
        parser.add_argument(
            "--agent", choices=("fold-lines", "oracle", "random-drags"), default="fold-lines",
            help="who folds: once along each true line, or again until it is near the ideal, or nobody who means it "
            "(default: fold-lines)",
        )  # fmt: skip
        parser.add_argument("--split", choices=("seen", "unseen"), default="seen", help="of the tasks (default: seen)")
        parser.add_argument("--tasks", nargs="+", default=(), metavar="ID", help="only these, ids or patterns")
        parser.add_argument("--garments", type="count", default=20, metavar="N", help="for each task (default: 20)")
        parser.add_argument("--first-seed", type="seed", default=1000, metavar="N", help="of them (default: 1000)")
        parser.add_argument("--edge-length", type="metres", default=0.018, metavar="M", help="default: 0.018")
        parser.add_argument("--workers", type="count", default=1, metavar="N", help="processes (default: 1)")
        parser.add_argument("--picture", type=Path, metavar="PNG", help="draw some of what the folder holds as well")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Demonstrate what is missing."""
        try:
            told = collect(_plan(arguments), arguments.out, arguments.workers)
        except KeyboardInterrupt:
            print(f"interrupted; what is finished is in {arguments.out}, run the same command to go on")
            raise
        counts = told["counts"]
        print(f"{counts['folds']} folds of {counts['demonstrations']} demonstrations in {arguments.out}")
        if counts["broken off"]:
            print(f"  {counts['broken off']} broke off and hold nothing")
        if arguments.picture is not None:
            from polyfold import viz
            from polyfold_baselines.demos.pictures import sheet
            from polyfold_baselines.demos.store import Demos as Read

            viz.save(sheet(Read.read(arguments.out)), arguments.picture)
            print(f"picture: {arguments.picture}")
        return 0


def collect(plan: DemoPlan, out: Path, workers: int = 1, progress: bool = True) -> dict[str, Any]:
    """Demonstrate what a folder lacks, and finish it.

    Raises:
        ConfigError: if the folder holds other demonstrations, is in use, or no task is chosen.
    """
    from tqdm.auto import tqdm

    from polyfold.logs import exclusive
    from polyfold.studies import in_processes
    from polyfold_baselines.demos.demonstrating import demonstrate
    from polyfold_baselines.demos.drags import drag_at_random
    from polyfold_baselines.demos.store import DemoFolder

    plan.check()
    made = drag_at_random if plan.agent == "random-drags" else demonstrate
    total = len(plan.jobs())
    with exclusive(out):
        folder = DemoFolder(out, plan)
        missing = sorted(set(range(total)) - folder.jobs())
        with tqdm(total=total, initial=total - len(missing), unit="demo", disable=not progress) as bar:
            for job, arrays in in_processes(partial(made, plan), missing, workers):
                folder.write(job, arrays)
                bar.update()
        return folder.finish()


def _plan(arguments: argparse.Namespace) -> DemoPlan:
    from pydantic import ValidationError

    from polyfold_baselines.demos.demonstrating import DemoPlan

    first = arguments.first_seed
    try:
        return DemoPlan(
            split=arguments.split,
            tasks=tuple(arguments.tasks),
            arms=arguments.arms,
            agent=arguments.agent,
            seeds=(first, first + arguments.garments - 1),
            edge_length=arguments.edge_length,
        )
    except ValidationError as error:
        raise ConfigError(validation_problem(error)) from error
