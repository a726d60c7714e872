"""One process at a time in a folder: a lock that ends with its holder, and a note of who holds it."""

from __future__ import annotations

import errno
import json
import os
import platform
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from polyfold.errors import ConfigError
from polyfold.errors._hints import file_problem
from polyfold.logs._disk.files import write_atomically

if TYPE_CHECKING:
    from filelock import BaseFileLock

RENEWED = 30.0
"""Seconds between signs of life."""

LOST = 120.0
"""Seconds without a sign of life after which a holder on another machine counts as gone."""

SOFT_WAIT = 0.5
"""Seconds to wait for a lock that is only a file: filelock 3.32 takes one whose holder is gone at its second try."""


@contextmanager
def exclusive(folder: str | Path) -> Iterator[Path]:
    """Work in a folder that no other process works in; it is made if need be.

    The operating system's lock ends with its holder, however that ends. Network file systems may keep locks to one
    machine; there the note beside it, renewed every 30 s, tells of a holder elsewhere.

    Args:
        folder: where.

    Raises:
        ConfigError: if another process works there, with its number and machine, or the folder can't be made.
    """
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = _acquired(folder)
    except OSError as error:
        raise ConfigError(file_problem(error, error.filename or folder)) from error
    try:
        _refuse_elsewhere(folder)
        with _note(folder):
            yield folder
    finally:
        lock.release()


def _acquired(folder: Path) -> BaseFileLock:
    from filelock import FileLock, SoftFileLock, Timeout

    try:
        try:
            return _taken(FileLock(folder / ".lock"))
        except (NotImplementedError, OSError) as error:
            if isinstance(error, OSError) and error.errno not in (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS):
                raise
            return _taken(SoftFileLock(folder / ".soft-lock"), SOFT_WAIT)
    except Timeout:
        holder = _holder(folder)
        raise ConfigError(
            f"{folder} is in use by {holder or 'another process'}; wait until that has finished, or use another folder"
        ) from None


def _taken(lock: BaseFileLock, wait: float = 0.0) -> BaseFileLock:
    lock.acquire(timeout=wait)
    return lock


def _holder(folder: Path) -> str:
    """Who holds it, in words; empty where the note is missing or unreadable."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        note = json.loads((folder / _NOTE).read_text("utf-8"))
        return f"process {note['pid']} on {note['host']} since {note['since']}"
    return ""


_NOTE = ".holder.json"


def _refuse_elsewhere(folder: Path) -> None:
    """Whoever got the lock is alone on this machine; a note that is still renewed is of a holder on another."""
    note = folder / _NOTE
    with suppress(OSError, ValueError, AttributeError):
        if json.loads(note.read_text("utf-8")).get("host") == platform.node():
            return
        probe = folder / f".{os.getpid()}.now"
        probe.touch()  # in the file system's own time
        age = probe.stat().st_mtime - note.stat().st_mtime
        probe.unlink()
        if age < LOST:
            raise ConfigError(
                f"{folder} is in use by {_holder(folder)}, another machine; wait until that has finished, or, if it "
                f"has ended, {LOST:.0f} s from its end, or use another folder"
            )


@contextmanager
def _note(folder: Path) -> Iterator[None]:
    path, ended = folder / _NOTE, threading.Event()
    since = datetime.now(UTC).isoformat(timespec="seconds")
    write_atomically(path, json.dumps({"pid": os.getpid(), "host": platform.node(), "since": since}) + "\n")

    def renew() -> None:
        while not ended.wait(RENEWED):
            with suppress(OSError):
                os.utime(path)

    threading.Thread(target=renew, daemon=True).start()
    try:
        yield
    finally:
        ended.set()
        path.unlink(missing_ok=True)
