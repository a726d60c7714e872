"""Runs a study: in this process, in several, or on a Dask cluster; resumable, with progress.

A finished episode is on disk before the next is waited for, so killing a run at any moment loses at most what was in
flight, and running it again does only what is missing, and again what failed for lack of an answer by the language
model.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.evaluation import evaluate_with_picture
from polyfold.store import RunDirectory, write_atomically
from polyfold.study import Cell, Study, cells, experiment_of
from polyfold.thumbnails import PICTURES, picture_path

__all__ = ["ENGINES", "evaluate"]

ENGINES = ("local", "dask")
Record = dict[str, Any]

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def evaluate(
    study: Study,
    out: str | Path,
    workers: int = 1,
    engine: str = "local",
    address: str | None = None,
    progress: bool = True,
    pictures: str = "failed",
) -> list[Record]:
    """Run what a directory lacks of a study and return all its records, in the study's order.

    Args:
        study: what to run.
        out: run directory; made if needed, resumed if it holds the same study.
        workers: processes on this machine.
        engine: ``local`` or ``dask``.
        address: of the Dask scheduler; without one a cluster of ``workers`` is started on this machine.
        progress: show a progress bar with rate, time left and running success.
        pictures: which episodes get a small picture beside their record: ``none``, ``failed`` (and the first episode
            of each task) or ``all``.

    Raises:
        ConfigError: if the directory belongs to another study, or a component can't reach the workers.
        LLMAccessError: if a variant's language model lacks its key; before anything is folded.
    """
    if engine not in ENGINES:
        raise ConfigError(f"there is no engine {engine!r}; choose one of {', '.join(ENGINES)}")
    if pictures not in PICTURES:
        raise ConfigError(f"there are no pictures {pictures!r}; choose one of {', '.join(PICTURES)}")
    run = RunDirectory(out, {"study": study.model_dump(mode="json")})
    wanted = list(cells(study))
    done = {key: record for key, record in run.episodes().items() if not _unanswered(record)}
    missing = [cell for cell in wanted if cell.key not in done]
    if missing and (workers > 1 or engine == "dask"):
        _check_portable()
    _check_language_models(study, missing)
    job = partial(evaluate_with_picture, study, pictures=pictures)
    with closing(_results(job, missing, workers, engine, address)) as results:
        shown = _with_progress(results, len(wanted), list(done.values()), progress and bool(missing))
        for cell, (record, picture) in shown:
            run.append(cell.key, _with_picture(run.path, cell, record, picture))
    done = run.episodes()
    return [done[cell.key] for cell in wanted]


def _unanswered(record: Record) -> bool:
    """Whether the episode ended because its language model gave no answer, which may go better another time."""
    return record["failure"] is not None and record["failure"]["stage"] == "unanswered"


def _with_picture(folder: Path, cell: Cell, record: Record, picture: bytes | None) -> Record:
    """The record with the relative path of its picture, which is on disk before the record is."""
    if picture is None:
        return record
    path = picture_path(cell.key)
    (folder / path).parent.mkdir(exist_ok=True)
    write_atomically(folder / path, picture)
    return {**record, "picture": path}


Outcome = tuple[Record, bytes | None]
Job = Callable[[Cell], Outcome]
Results = Iterator[tuple[Cell, Outcome]]


def _results(job: Job, missing: Sequence[Cell], workers: int, engine: str, address: str | None) -> Results:
    if missing and engine == "dask":
        return _on_dask(job, missing, workers, address)
    return _in_processes(job, missing, workers) if missing and workers > 1 else _here(job, missing)


def _here(job: Job, missing: Sequence[Cell]) -> Results:
    for cell in missing:
        yield cell, job(cell)


def _in_processes(job: Job, missing: Sequence[Cell], workers: int) -> Results:
    """The first episode runs here and fills the compiler's cache; then the workers start from it."""
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
    from multiprocessing import get_context

    yield missing[0], job(missing[0])
    waiting = iter(missing[1:])
    with _one_thread_each():
        pool = ProcessPoolExecutor(workers, get_context("spawn"), _prepare_worker, (plugins.portable(),))
        try:
            running = {pool.submit(job, cell): cell for cell in _first(waiting, 2 * workers)}
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    cell = running.pop(future)
                    yield cell, future.result()
                    running |= {pool.submit(job, more): more for more in _first(waiting, 1)}
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _first(cells_left: Iterator[Cell], count: int) -> list[Cell]:
    return [cell for _, cell in zip(range(count), cells_left, strict=False)]


def _one_thread_each() -> Any:
    """Libraries of the workers keep to one thread: the parallelism is in the episodes."""
    from unittest.mock import patch

    return patch.dict(os.environ, dict.fromkeys(_THREADS, "1"))


def _prepare_worker(registrations: Sequence[tuple[str, str, str]]) -> None:
    """Leave Ctrl-C to the parent, end with it, and know what was registered by hand."""
    import multiprocessing
    import signal
    import threading

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
    for kind, name, target in registrations:
        plugins.register(kind, name, target)


def _on_dask(job: Job, missing: Sequence[Cell], workers: int, address: str | None) -> Results:
    try:
        from distributed import Client, LocalCluster, as_completed
    except ModuleNotFoundError as error:
        raise ConfigError("the engine 'dask' needs: pip install distributed") from error
    with _one_thread_each():
        cluster = None if address else LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        with Client(address or cluster) as client:
            try:
                for kind, name, target in plugins.portable():
                    client.run(plugins.register, kind, name, target)
                running = {client.submit(job, cell, pure=False): cell for cell in missing}
                for future, record in as_completed(list(running), with_results=True):
                    yield running.pop(future), record
            finally:
                if cluster is not None:
                    cluster.close()


def _with_progress(results: Results, total: int, done: Sequence[Record], shown: bool) -> Results:
    from tqdm import tqdm

    successes = sum(record["success"]["polyfold"] for record in done)
    with tqdm(total=total, initial=len(done), unit="episode", disable=not shown) as bar:
        for finished, (cell, (record, picture)) in enumerate(results, len(done) + 1):
            yield cell, (record, picture)
            successes += record["success"]["polyfold"]
            bar.set_postfix_str(f"success {successes / finished:.0%}", refresh=False)
            bar.update()


def _check_language_models(study: Study, missing: Sequence[Cell]) -> None:
    """Construct each variant's once, so that no run ends at its second variant for want of a key."""
    for variant in dict.fromkeys(cell.variant for cell in missing):
        experiment = experiment_of(study, variant)
        agent = plugins.component_class("agents", experiment.agent.name.partition(":")[0])
        if "instruction" in getattr(agent, "requires", ()):
            experiment.create("llms", "llm")


def _check_portable() -> None:
    """Refuse components that a worker could not import."""
    portable = {(kind, name) for kind, name, _ in plugins.portable()}
    for kind, name in plugins.by_hand():
        if (kind, name) not in portable:
            raise ConfigError(
                f"{name!r} was registered from a notebook or script and can't reach worker processes; "
                "put its class into a module that can be imported, or run with workers=1"
            )
