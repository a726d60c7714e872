"""Jobs in worker processes."""

from concurrent.futures import Future

import pytest

from polyfold.errors import ConfigError
from polyfold.studies import in_processes
from polyfold.studies._executors import _result_from_dask


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("count", [0, 1, 20])
def test_every_job_is_done_once_however_many_there_are(workers, count):
    assert sorted(in_processes(abs, range(count), workers)) == [(job, job) for job in range(count)]


def test_jobs_are_read_as_workers_become_free():
    read = []
    jobs = (read.append(job) or job for job in range(100))
    results = in_processes(abs, jobs, 2)
    assert next(results) == (0, 0)
    assert read == [0], "the first job runs here, before anything is started"
    next(results)
    assert len(read) <= 6
    results.close()


def threads_of_opencv(_):
    import cv2

    return cv2.getNumThreads()


def test_workers_keep_to_one_thread_each():
    _, *in_workers = in_processes(threads_of_opencv, range(4), 2)
    assert [threads for _, threads in in_workers] == [1, 1, 1]


def test_an_error_of_a_job_ends_the_run_with_that_error():
    with pytest.raises(TypeError):
        list(in_processes(abs, [1, 2, "three"], 2))


def test_a_job_that_the_cluster_lost_ends_with_what_to_do():
    lost = Future()
    lost.cancel()
    with pytest.raises(ConfigError, match=r"the Dask cluster was lost .*: run again once its scheduler is back"):
        _result_from_dask(lost)
