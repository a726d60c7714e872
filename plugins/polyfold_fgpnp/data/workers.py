"""Independent jobs in several processes, their results as they come."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def in_processes(work: Callable[[Job], Result], jobs: Iterable[Job], workers: int) -> Iterator[tuple[Job, Result]]:
    """Yield (job, result) in the order of completion. The first job runs here and fills the compiler's cache.

    Worker processes keep to one thread each and end with this one, however it ends.
    """
    from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
    from multiprocessing import get_context
    from unittest.mock import patch

    waiting = iter(jobs)
    for job in waiting:
        yield job, work(job)
        if workers > 1:
            break
    running: dict[Future[Any], Job] = {}
    with patch.dict(os.environ, dict.fromkeys(_THREADS, "1")):
        pool = ProcessPoolExecutor(workers, get_context("spawn"), _prepare_worker)
        try:
            for job in islice(waiting, 2 * workers):
                running[pool.submit(work, job)] = job
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    yield running.pop(future), future.result()
                    for job in waiting:
                        running[pool.submit(work, job)] = job
                        break
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it."""
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
