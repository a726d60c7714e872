from polyfold_fgpnp.data.workers import in_processes


def test_every_job_is_done_once_however_many_there_are():
    for workers in (1, 2):
        assert sorted(in_processes(abs, range(20), workers)) == [(job, job) for job in range(20)]
