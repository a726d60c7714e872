"""Where independent jobs run: in this process, in several, or on a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import AbstractContextManager
from itertools import islice
from typing import Any, TypeVar

from polyfold import plugins
from polyfold.errors import ConfigError

_Job = TypeVar("_Job")
_Result = TypeVar("_Result")

_THREADS = (
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "OPENCV_FOR_THREADS_NUM",
)  # fmt: skip


def in_processes(
    work: Callable[[_Job], _Result], jobs: Iterable[_Job], workers: int
) -> Generator[tuple[_Job, _Result], None, None]:
    """Run independent jobs in processes of this machine and yield (job, result) as they finish.

    The first job runs here and fills the compiler's cache, from which the workers start. Workers keep to one thread
    each, know the plugins and components that this process knows, leave Ctrl-C to this process, and end with it however
    it ends. A caller that keeps each result before it asks for the next loses at most the jobs in flight when killed.

    Args:
        work: what to do; must be importable by the workers.
        jobs: what to do it with; read as workers become free.
        workers: number of processes; with 1 all jobs run here.
    """
    waiting = iter(jobs)
    for job in waiting if workers <= 1 else islice(waiting, 1):
        yield job, work(job)
    if workers > 1:
        yield from _in_pool(work, waiting, workers)


def _in_pool(
    work: Callable[[_Job], _Result], waiting: Iterator[_Job], workers: int
) -> Generator[tuple[_Job, _Result], None, None]:
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
    from multiprocessing import get_context

    with _one_thread_each():
        known = plugins.portable(), plugins.third_party()
        pool = ProcessPoolExecutor(workers, get_context("spawn"), _prepare_worker, known)
        running: dict[Future[_Result], _Job] = {}
        begun = False
        try:
            running |= {pool.submit(work, job): job for job in islice(waiting, 2 * workers)}
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    yield running.pop(future), _result_of(future, begun)
                    begun = True
                    running |= {pool.submit(work, job): job for job in islice(waiting, 1)}
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _result_of(future: Future[_Result], begun: bool) -> _Result:
    """A job's result. Raises ConfigError if the workers have died, ``begun`` or not."""
    from concurrent.futures.process import BrokenProcessPool

    try:
        return future.result()
    except BrokenProcessPool as error:
        if begun:
            raise ConfigError(
                "a worker process died, perhaps for want of memory; run again to go on, with fewer workers"
            ) from error
        raise ConfigError(
            "the worker processes could not begin: they import the script that starts them, so let it work under "
            'if __name__ == "__main__": (a script on standard input can have no such guard; use workers=1)'
        ) from error


def on_dask(
    work: Callable[[_Job], _Result], jobs: Sequence[_Job], workers: int, address: str | None
) -> Generator[tuple[_Job, _Result], None, None]:
    """Run independent jobs on a Dask cluster and yield (job, result) as they finish.

    Args:
        work: what to do; must be importable by the workers.
        jobs: what to do it with.
        workers: size of the cluster that is started on this machine if there is no ``address``.
        address: of the scheduler of a running cluster.

    :func:`check_dask` says first whether there is one.

    Raises:
        ConfigError: if the cluster is lost on the way.
    """
    from distributed import (  # pyright: ignore[reportMissingImports]  (an optional package)
        Client,
        LocalCluster,
        as_completed,
    )

    with _one_thread_each():
        cluster = None if address else LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        with Client(address or cluster) as client:
            try:
                client.run(plugins.refresh, plugins.third_party())
                for kind, name, target in plugins.portable():
                    client.run(plugins.receive, kind, name, target)
                running = {client.submit(work, job, pure=False): job for job in jobs}
                # With results, as_completed of distributed 2026.8 hands out the error of a lost job as its result.
                for future in as_completed(list(running)):
                    yield running.pop(future), _result_from_dask(future)
            finally:
                if cluster is not None:
                    cluster.close()


def _result_from_dask(future: Any) -> Any:
    """A job's result. Raises ConfigError if the cluster has lost it."""
    from concurrent.futures import CancelledError

    try:
        return future.result()
    except CancelledError as error:
        said = " ".join(str(error).split())
        raise ConfigError(
            f"the Dask cluster was lost ({said}); what is done is kept: run again once its scheduler is back"
        ) from error


def check_dask(address: str | None) -> None:
    """Find out whether there is a cluster to run on, before anything is written.

    Raises:
        ConfigError: if Dask is not installed, or nobody answers at the address.
    """
    try:
        from distributed import Client  # pyright: ignore[reportMissingImports]  (an optional package)
    except ModuleNotFoundError as error:
        raise ConfigError("the engine 'dask' needs: pip install distributed") from error
    if address is None:
        return
    try:
        Client(address, timeout=_ANSWERS_WITHIN).close()
    except (OSError, ValueError, TimeoutError) as error:
        raise ConfigError(
            f"no Dask scheduler answers at {address!r} ({error}); give its address, for example tcp://10.0.0.1:8786, "
            "or leave it out to start a cluster here"
        ) from error


_ANSWERS_WITHIN = 10
"""Seconds that a scheduler has to answer."""


def _one_thread_each() -> AbstractContextManager[Any]:
    """Libraries of the workers keep to one thread: the parallelism is in the jobs."""
    from unittest.mock import patch

    return patch.dict(os.environ, dict.fromkeys(_THREADS, "1"))


def _prepare_worker(registrations: Sequence[tuple[str, str, str | bytes]], third_party: bool) -> None:
    """Leave Ctrl-C to the parent, end with it, and know the plugins and components that it knows."""
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
    plugins.refresh(third_party)
    for kind, name, target in registrations:
        plugins.receive(kind, name, target)
