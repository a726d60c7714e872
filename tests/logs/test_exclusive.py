import json
import os
import platform
import signal
import subprocess
import sys
import time

import pytest

from polyfold.errors import ConfigError
from polyfold.logs import exclusive

HOLDER = """
import sys, time
from polyfold.logs import exclusive
with exclusive(sys.argv[1]):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that works in the folder."""
    child = subprocess.Popen([sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE)
    assert child.stdout is not None
    assert child.stdout.readline() == b"held\n"
    yield child
    child.kill()
    child.wait()


def test_a_second_process_is_told_who_works_there(tmp_path, holder):
    with (
        pytest.raises(ConfigError, match=rf"in use by process {holder.pid} on {platform.node()}.*another folder"),
        exclusive(tmp_path),
    ):
        pass


def test_a_killed_holder_holds_no_longer(tmp_path, holder):
    os.kill(holder.pid, signal.SIGKILL)
    holder.wait()
    assert (tmp_path / ".holder.json").exists()
    with exclusive(tmp_path):
        assert json.loads((tmp_path / ".holder.json").read_text())["pid"] == os.getpid()
    assert not (tmp_path / ".holder.json").exists()


LOCKLESS_HOLDER = (
    """
import errno, filelock
class NoLocks(filelock.FileLock):
    def _acquire(self):
        raise OSError(errno.ENOLCK, "no locks here")
filelock.FileLock = NoLocks
"""
    + HOLDER
)


def test_where_a_disk_has_no_locks_a_file_stands_in_and_ends_with_its_holder_too(tmp_path):
    command = [sys.executable, "-c", LOCKLESS_HOLDER, str(tmp_path)]
    for _ in range(2):
        holding = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert holding.stdout is not None
        assert holding.stdout.readline() == b"held\n", holding.communicate()
        refused = subprocess.run(command, capture_output=True, text=True, check=False)
        assert f"in use by process {holding.pid}" in refused.stderr
        holding.kill()
        holding.communicate()


def note_of_another_machine(folder, age):
    note = folder / ".holder.json"
    note.write_text(json.dumps({"pid": 7, "host": "elsewhere", "since": "2026-01-01T00:00:00+00:00"}))
    then = time.time() - age
    os.utime(note, (then, then))


def test_a_holder_on_another_machine_counts_while_it_gives_signs_of_life(tmp_path):
    note_of_another_machine(tmp_path, age=20)
    with pytest.raises(ConfigError, match="process 7 on elsewhere"), exclusive(tmp_path):
        pass
    note_of_another_machine(tmp_path, age=1000)
    with exclusive(tmp_path):
        pass


def test_of_racing_processes_one_works_and_the_others_say_why(tmp_path):
    script = HOLDER.replace("time.sleep(60)", "time.sleep(2)")
    racing = [
        subprocess.Popen([sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for _ in range(4)
    ]
    said = [child.communicate() for child in racing]
    held = [out for out, _ in said if out == b"held\n"]
    refused = [err for _, err in said if b"is in use by" in err]
    assert len(held) >= 1
    assert len(held) + len(refused) == 4
