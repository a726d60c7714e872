"""``polyfold export``: fold tasks and write the folds for others to learn from."""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.errors import ConfigError

if TYPE_CHECKING:
    from polyfold_interchange.lerobot import Recording

Job = tuple[str, int]
"""A task and a garment's seed."""
EXPORTED = "polyfold-export.json"
"""What says in a data set which command made it."""


class Export:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument(
            "--out", type=Path, required=True, metavar="DIR", help="data set; goes on if it was stopped"
        )
        parser.add_argument("--suite", default="polyfold70", metavar="NAME", help="task suite (default: polyfold70)")
        parser.add_argument(
            "--split",
            choices=("seen", "unseen"),
            default="seen",
            help="of the tasks, unless --tasks names them (default: seen)",
        )
        parser.add_argument(
            "--tasks", nargs="+", default=(), metavar="ID", help="only these tasks; square-corner-* is several"
        )
        parser.add_argument("--agent", default="fold-lines", metavar="NAME", help="who folds (default: fold-lines)")
        parser.add_argument("--garments", type="count", default=5, metavar="N", help="for each task (default: 5)")
        parser.add_argument("--first-seed", type="seed", default=1000, metavar="N", help="of them (default: 1000)")
        parser.add_argument("--edge-length", type="metres", default=0.018, metavar="M", help="default: 0.018")
        parser.add_argument("--workers", type="count", default=1, metavar="N", help="processes (default: 1)")
        parser.add_argument("--all", action="store_true", help="keep episodes that failed as well")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Fold what is missing, then write the data set."""
        from polyfold import plugins

        plugins.find("agents", arguments.agent)
        jobs = _jobs(arguments.suite, arguments.split, arguments.tasks, arguments.first_seed, arguments.garments)
        fold = partial(recorded, arguments.suite, arguments.agent, arguments.edge_length, arguments.all)
        settings = [arguments.suite, arguments.agent, arguments.edge_length, arguments.all]
        try:
            kept = export(jobs, fold, arguments.out, arguments.workers, settings)
        except KeyboardInterrupt:
            print(f"interrupted; what is finished is beside {arguments.out}, run the same command to go on")
            raise
        print(f"{kept} of {len(jobs)} episodes in {arguments.out}; LeRobotDataset('mine', root={str(arguments.out)!r})")
        return 0


def export(jobs: Sequence[Job], fold: Any, out: Path, workers: int, settings: Any) -> int:
    """Fold what is missing in a folder beside ``out``, then write it there; returns how many episodes it holds.

    Raises:
        ConfigError: if ``out`` holds something, or no episode is worth keeping.
    """
    from tqdm.auto import tqdm

    from polyfold.studies import in_processes
    from polyfold_interchange.lerobot import write_dataset

    whole = json.loads(json.dumps({"settings": settings, "jobs": list(jobs)}))
    if (kept := _finished(out, whole)) is not None:
        return kept
    digest = hashlib.sha256(json.dumps(settings).encode()).hexdigest()[:12]
    parts = out.with_name(f"{out.name}.parts-{digest}")
    parts.mkdir(parents=True, exist_ok=True)
    missing = [job for job in jobs if not _part(parts, job).exists()]
    with tqdm(total=len(jobs), initial=len(jobs) - len(missing), unit="episode") as bar:
        for job, recording in in_processes(fold, missing, workers):
            _keep(recording, _part(parts, job))
            bar.update()
    found = [one for job in jobs if (one := _read(_part(parts, job))) is not None]
    if not found:
        raise ConfigError(
            "no episode succeeded, so there is nothing to export; keep failures with --all, or change --agent"
        )
    write_dataset(found, out)
    (out / EXPORTED).write_text(json.dumps({**whole, "episodes": len(found)}), "utf-8")
    for job in jobs:
        _part(parts, job).unlink()
    if not any(parts.iterdir()):
        parts.rmdir()
    return len(found)


def _finished(out: Path, whole: Mapping[str, Any]) -> int | None:
    """How many episodes a folder holds that the same command made; None where it is to be made.

    Raises:
        ConfigError: if it holds something else.
    """
    if not out.exists() or not any(out.iterdir()):
        return None
    file = out / EXPORTED
    told = json.loads(file.read_text("utf-8")) if file.is_file() else {}
    if {name: told.get(name) for name in whole} != dict(whole):
        raise ConfigError(f"{out} holds something else already; choose another folder")
    return int(told["episodes"])


def recorded(suite_name: str, agent: str, edge_length: float, failed_too: bool, job: Job) -> Recording | None:
    """One task on one garment, folded; None for what is not worth keeping."""
    from polyfold import plugins
    from polyfold.config import Experiment
    from polyfold.evaluation import judge, suite
    from polyfold.rollout import run_episode
    from polyfold_interchange.lerobot import Recording

    name, seed = job
    task = suite(suite_name).task(name)
    garment = plugins.generate_garment(task.garment, seed, edge_length)
    sentence = task.instructions[seed % len(task.instructions)] if task.instructions else task.id
    episode = run_episode(Experiment.of(agent=agent), garment, sentence, seed, task=task)
    told = judge(episode, task).fidelity if episode.steps else None
    good = told is not None and told.verdict in ("good", "fair")
    return Recording.of(episode) if episode.steps and (good or failed_too) else None


def _jobs(suite_name: str, split: str, tasks: Sequence[str], first_seed: int, garments: int) -> list[Job]:
    from polyfold.evaluation import suite
    from polyfold.tasks import Task

    found = suite(suite_name)
    chosen = found.matching(tasks) if tasks else [task for task in found.tasks if task.split in (split, None)]
    if goals := [task.id for task in chosen if not isinstance(task, Task)]:
        raise ConfigError(f"{goals[0]} leaves its folds open, so that nobody can show them; choose tasks with folds")
    return [(task.id, seed) for seed in range(first_seed, first_seed + garments) for task in chosen]


def _part(parts: Path, job: Job) -> Path:
    return parts / f"{job[0]}-{job[1]}.npz"


def _keep(recording: Recording | None, path: Path) -> None:
    """Write one episode, whole or not at all; an empty one for what is not worth keeping."""
    import numpy as np

    arrays = {} if recording is None else {**vars(recording), "sentence": np.str_(recording.sentence)}
    part = path.with_suffix(".part")
    with part.open("wb") as stream:
        np.savez_compressed(stream, **arrays)
    part.replace(path)


def _read(path: Path) -> Recording | None:
    import numpy as np

    from polyfold_interchange.lerobot import Recording

    with np.load(path, allow_pickle=False) as stored:
        if "actions" not in stored:
            return None
        return Recording(str(stored["sentence"]), stored["pictures"], stored["states"], stored["actions"])
