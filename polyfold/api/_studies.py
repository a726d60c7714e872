"""Running studies and opening what they left."""

from __future__ import annotations

from pathlib import Path

from polyfold.analysis import Results, open_results
from polyfold.logs import read_run
from polyfold.studies import Study
from polyfold.studies._run import evaluate
from polyfold.viz._thumbnails import thumbnail


def run(
    study: Study,
    out: str | Path,
    workers: int = 1,
    engine: str = "local",
    address: str | None = None,
    progress: bool = True,
    pictures: str = "failed",
    accept_change: bool = False,
) -> Results:
    """Run a study, or what its directory lacks of it; see :func:`polyfold.studies.evaluate`."""
    records = evaluate(study, out, workers, engine, address, progress, pictures, thumbnail, accept_change)
    return Results(read_run(out), records)


def open(out: str | Path) -> Results:
    """The results in a run directory, finished or not. Raises ConfigError if there is none."""
    return open_results(out)
