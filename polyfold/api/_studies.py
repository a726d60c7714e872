"""Running studies and opening what they left."""

from __future__ import annotations

from pathlib import Path

from polyfold.analysis import Results
from polyfold.analysis._results import open_results
from polyfold.errors import ConfigError
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
    """Run a study, or what its directory lacks of it.

    A finished episode is on disk before the next is waited for: killing a run at any moment loses at most what was in
    flight, and running it again does only what is missing.

    Args:
        study: what to run.
        out: run directory; made if needed, resumed if it holds the same study.
        workers: processes on this machine.
        engine: ``local`` or ``dask``.
        address: of the Dask scheduler; without one a cluster of ``workers`` is started on this machine.
        progress: show a progress bar with rate, time left and running success.
        pictures: which episodes get a small picture beside their record: ``none``, ``failed`` (and the first episode
            of each task) or ``all``.
        accept_change: go on with a run although code, prompts, weights or the commit have changed since; the run
            records it.

    Returns:
        The results, in the study's order.

    Raises:
        ConfigError: if the directory belongs to another study, what results depend on has changed, or a component
            can't reach the workers.
        LLMAccessError: if a variant's language model lacks its key; before anything is folded.
    """
    if not isinstance(study, Study):
        raise ConfigError(f"{study!r} is no study; give a polyfold.Study, or the file by polyfold.load(path)")
    records = evaluate(study, out, workers, engine, address, progress, pictures, thumbnail, accept_change)
    return Results(read_run(out), records)


open = open_results
