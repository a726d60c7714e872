"""Measure the whole loop on unseen garments: ``python -m experiments.benchmarks.loop``.

Standard jobs on the evaluation garments (seeds 0 and up), from a sentence to the final picture, judged against
the ideal along lines from ground-truth keypoints; the agents ``noop`` and ``random`` beside the method. The run
directory can be killed and resumed; running again does only what is missing and prints the table.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from polyfold import plugins
from polyfold.api import attempt, garment
from polyfold.config import Experiment
from polyfold.logs import FoldRecord, RunDirectory, exclusive
from polyfold.logs._records import KeyedRecord
from polyfold.logs._writing import fold_record


@dataclass(frozen=True)
class Job:
    """A sentence and the task it means."""

    name: str
    garment: str
    task: str
    instruction: str


JOBS = (
    Job("t-shirt, block", "tshirt", "tshirt-block-left-first", "fold the t-shirt into a rectangular block"),
    Job(
        "pants, block",
        "pants",
        "pants-block-left-halves",
        "fold the left leg over onto the right leg, then halve the trousers from the bottom up twice",
    ),
    Job("pants, half", "pants", "pants-half-left", "fold the left leg of the pants over onto the right leg"),
    Job(
        "square, diagonal",
        "square",
        "square-triangle-bottom_left",
        "fold the bottom left corner onto the top right corner",
    ),
    Job(
        "square, both diagonals",
        "square",
        "square-triangle-bottom_left-then-top_left",
        "fold the bottom left corner onto the top right corner, then the top left corner onto the bottom right corner",
    ),
    Job("square, four corners", "square", "square-corners-all", "fold all four corners into the centre"),
    Job(
        "rectangle, quarters",
        "rectangle",
        "rectangle-half-left-then-bottom",
        "fold the left edge onto the right edge, then fold the bottom edge up to the top edge",
    ),
    Job(
        "rectangle, eighths",
        "rectangle",
        "rectangle-eighths",
        "fold the left edge onto the right edge, then fold the bottom edge up to the top edge, "
        "then fold the left edge onto the right edge",
    ),
)
SUITE = Path(__file__).with_suffix(".toml")
"""Tasks that are not of an installed suite."""
GOOD = 0.90
"""IoU that counts as well folded."""
AGENTS = ("polyfold", "noop", "random")


class JobRecord(KeyedRecord, FoldRecord):
    """One episode.

    Attributes:
        job: name of the job.
        good: IoU that counts as well folded.
    """

    job: str
    good: float


def main(arguments: list[str] | None = None) -> None:
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description="Measure the whole loop on unseen garments.")
    parser.add_argument("--n", type=int, default=20, help="garments per job (default: 20)")
    parser.add_argument("--first-seed", type=int, default=0, help="0 for the evaluation garments; develop from 2000")
    parser.add_argument("--agent", action="append", choices=AGENTS, help="only this agent; may be repeated")
    parser.add_argument("--job", action="append", choices=[job.task for job in JOBS], help="only this job")
    parser.add_argument(
        "--policy", default="affordance-pair", help="policy of the polyfold agent (default: affordance-pair)"
    )
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark-loop"), help="run directory, resumed")
    chosen = parser.parse_args(arguments)
    plugins.register("tasks", "benchmark-loop", str(SUITE))
    jobs = [job for job in JOBS if chosen.job is None or job.task in chosen.job]
    agents = tuple(chosen.agent or AGENTS)
    with exclusive(chosen.out):
        run = RunDirectory(chosen.out, {"benchmark": "loop", "policy": chosen.policy}, JobRecord)
        _complete(run, jobs, agents, range(chosen.first_seed, chosen.first_seed + chosen.n), chosen.policy)
    wanted = {_key(job, agent, chosen.first_seed + i) for job in jobs for agent in agents for i in range(chosen.n)}
    print(table([record for key, record in run.records().items() if key in wanted]))


def _key(job: Job, agent: str, seed: int) -> str:
    return f"{job.task}/{agent}/{seed}"


def _complete(
    run: RunDirectory[JobRecord], jobs: Sequence[Job], agents: Sequence[str], seeds: Iterable[int], policy: str
) -> None:
    """Run the episodes that the directory does not hold yet."""
    done = run.records()
    missing = [
        (job, agent, seed) for seed in seeds for job in jobs for agent in agents if _key(job, agent, seed) not in done
    ]
    for job, agent, seed in tqdm(missing, desc="episodes", unit="episode", disable=not missing):
        run.append(_episode(job, agent, seed, policy))


def _episode(job: Job, agent: str, seed: int, policy: str) -> JobRecord:
    experiment = Experiment.of(agent=agent, policy=policy)
    episode = attempt(job.instruction, garment(job.garment, seed=seed), seed, experiment, task=job.task)
    return JobRecord(key=_key(job, agent, seed), job=job.name, good=GOOD, **dict(fold_record(episode)))


def table(records: Sequence[JobRecord]) -> str:
    """The results as a markdown table, a row per job and agent."""
    lines = [
        "| job | agent | n | IoU, mean | lowest | good | moved part [mm] | quality | failures | seconds an episode |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for job, agent, rows in _groups(records):
        judged = [row.fidelity for row in rows if row.fidelity is not None]
        iou = np.array([fidelity.iou for fidelity in judged])
        error = np.array([fidelity.moved_part_error_mm for fidelity in judged], float)
        quality = np.array([fidelity.quality for fidelity in judged], float)
        good = rows[0].good
        failures = sum(row.failure is not None for row in rows)
        seconds = np.mean([sum(row.seconds.values()) for row in rows])
        lines.append(
            f"| {job} | {agent} | {len(rows)} | {iou.mean():.3f} | {iou.min():.3f} | {(iou >= good).sum()} of "
            f"{len(rows)} at {good:.2f} | {np.nanmean(error):.1f} | {quality.mean():.0f} | {failures} | {seconds:.1f} |"
        )
    return "\n".join(lines)


def _groups(records: Sequence[JobRecord]) -> Iterator[tuple[str, str, list[JobRecord]]]:
    order = {(job.name, agent): None for job in JOBS for agent in AGENTS}
    for job, agent in order:
        rows = [record for record in records if (record.job, record.agent) == (job, agent)]
        if rows:
            yield job, agent, rows


if __name__ == "__main__":
    main()
