"""JSON lines on disk: one record a line, only ever appended, readable after a kill at any moment."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

from filelock import FileLock

from polyfold.errors import ConfigError
from polyfold.logs._disk.files import write_atomically

try:
    import fcntl
except ModuleNotFoundError:  # Windows
    fcntl = None

_BLOCK = 65_536

_Parsed = TypeVar("_Parsed")


@dataclass(frozen=True)
class Damage:
    """A line that can't be read: its number, itself, and what is wrong with it."""

    number: int
    line: bytes
    problem: str


class JsonLines:
    """A file with one JSON object a line, UTF-8, that several processes may append to and read at once.

    A line without an end was being written when a process was killed, or is being written right now. Readers leave it
    out; the next writer removes it.

    Args:
        path: the file; made, with its folders, by the first :meth:`append`.
        longest: longest line to take, reading and writing [bytes]; None for any.
    """

    def __init__(self, path: str | Path, longest: int | None = None) -> None:
        self.path = Path(path)
        self._longest = longest

    def append(self, content: Mapping[str, Any]) -> None:
        """Add a record as one line, whole or not at all; it is on disk when this returns.

        Raises:
            ConfigError: if the line would be too long, or the file can't be written.
        """
        line = _encoded(content) + b"\n"
        if self._longest is not None and len(line) > self._longest:
            raise ConfigError(f"a record of {len(line)} bytes is too long for {self.path}; make it shorter")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self._alone("a+b") as file:
                _drop_half_written_line(file)
                file.write(line)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise ConfigError(f"can't write {self.path} ({error.strerror}); choose another path") from error

    def read(self) -> list[dict[str, Any]]:
        """All records in the order they were added; none if there is no file.

        Raises:
            ConfigError: naming the line that is no JSON object, or too long.
        """
        return [self._record(line, number) for number, (line, _) in enumerate(self.lines(), 1)]

    def _record(self, line: bytes, number: int) -> dict[str, Any]:
        where = f"{self.path}, line {number}"
        try:
            record = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise ConfigError(f"{where} is not JSON ({error}); correct or remove the line") from error
        if not isinstance(record, dict):
            raise ConfigError(f"{where} is no JSON object; correct or remove the line")
        return record

    def sound(self, parse: Callable[[dict[str, Any], str], _Parsed]) -> tuple[list[_Parsed], list[Damage]]:
        """The records that can be read, and the lines that can't.

        Args:
            parse: makes what is wanted of a record, told where it stands; raises ConfigError where it can't.
        """
        found, damaged = list[_Parsed](), list[Damage]()
        for number, (line, _) in enumerate(self.lines(), 1):
            try:
                found.append(parse(self._record(line, number), f"{self.path}, line {number}"))
            except ConfigError as error:
                damaged.append(Damage(number, line, str(error)))
        return found, damaged

    def set_aside(self, damaged: Collection[Damage]) -> Path:
        """Move lines into a file beside this one; returns its path. Only for a file that nobody else writes to."""
        beside = self.path.with_name(f"{self.path.stem}.damaged{self.path.suffix}")
        taken = {damage.number for damage in damaged}
        kept = [line for number, (line, _) in enumerate(self.lines(), 1) if number not in taken]
        with beside.open("ab") as file:
            file.writelines(damage.line for damage in damaged)
            file.flush()
            os.fsync(file.fileno())
        write_atomically(self.path, b"".join(kept))
        return beside

    def lines(self, begin: int = 0, growing: bool = True) -> Iterator[tuple[bytes, int]]:
        """The lines as they stand, each with the byte it ends at, so that a reader can go on where it stopped.

        Args:
            begin: byte to begin at.
            growing: leave out a last line without an end; say no for a file that something else has finished.

        Raises:
            ConfigError: if a line is too long.
        """
        if not self.path.exists():
            return
        most = -1 if self._longest is None else self._longest + 1
        with self.path.open("rb") as file:
            file.seek(begin)
            while line := file.readline(most):
                if self._longest is not None and len(line) > self._longest:
                    raise ConfigError(f"{self.path} has a line of more than {self._longest} bytes; remove it")
                if growing and not line.endswith(b"\n"):
                    return
                if line.strip():
                    yield line, file.tell()

    def repair(self) -> None:
        """Remove a half-written last line, which a kill has left."""
        if self.path.exists():
            with self._alone("r+b") as file:
                _drop_half_written_line(file)

    @contextmanager
    def _alone(self, mode: str) -> Iterator[BinaryIO]:
        """The file, opened, while no other process writes to it; Windows locks a file beside it instead of itself."""
        with ExitStack() as held:
            if fcntl is None:
                held.enter_context(FileLock(f"{self.path}.lock"))
            file: BinaryIO = held.enter_context(self.path.open(mode))  # type: ignore[arg-type]
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX)
            yield file


def _encoded(content: Mapping[str, Any]) -> bytes:
    """UTF-8 that people can read; escaped where a text holds half a surrogate pair, which UTF-8 can't."""
    try:
        return json.dumps(content, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return json.dumps(content).encode()


def _drop_half_written_line(file: BinaryIO) -> None:
    """Whoever holds the lock is the only writer, so a last line without an end was left by a kill."""
    end = size = file.seek(0, os.SEEK_END)
    while end > 0:
        begin = max(0, end - _BLOCK)
        file.seek(begin)
        found = file.read(end - begin).rfind(b"\n")
        if found >= 0:
            end = begin + found + 1
            break
        end = begin
    if end != size:
        file.truncate(end)
