"""Where the episodes of a study run: in this process, in several, or on a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.studies._cells import Cell

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


Outcome = Any


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
