"""Cassettes: recorded requests and replies, one pair a line of JSON. Nothing in one is ever executed.

Each line holds ``key``, ``request`` (with pictures as SHA-256 and length), ``place`` in its episode, ``reply`` and the
day it was ``recorded``; or only ``key`` and ``place``, where another episode asked the same. Lines are only ever
appended, under a lock; a line that a kill cut in half is dropped.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields, replace
from datetime import UTC, datetime
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError, LLMError
from polyfold.logs import JsonLines
from polyfold.types import Reply
from polyfold_llms.redaction import contains_secret
from polyfold_llms.request_keys import REQUEST_VERSION, describe_difference, largest_difference, nearby_key, request_key

LONGEST_LINE = 8_000_000
LARGEST_FILE = 2_000_000_000

_REPLY = {field.name for field in fields(Reply)} - {"origin"}


@cache
def open_cassette(path: Path) -> Cassette:
    """The cassette of a path, one per process."""
    return Cassette(path)


class Cassette:
    """What was recorded in a file. Several processes and threads may read and append at once."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = threading.Lock()
        self._forget()

    def _forget(self) -> None:
        self._read = self._lines = 0
        self._entries: dict[str, dict[str, Any]] = {}
        self._nearby: dict[str, list[str]] = {}

    def refresh(self) -> None:
        """Read what was appended since. Raises ConfigError for a line that is no recording, with its number."""
        with self._lock:
            size = self.path.stat().st_size if self.path.exists() else 0
            if size < self._read:
                self._forget()
            if size == self._read:
                return
            for line, end in recorded_lines(self.path, self._read):
                self._keep(self._checked(line, f"{self.path}, line {self._lines + 1}"))
                self._lines, self._read = self._lines + 1, end

    def _keep(self, entry: dict[str, Any]) -> None:
        known = self._entries.setdefault(entry["key"], entry)
        nearby = nearby_key(known["request"], entry["place"])
        if nearby is not None and entry["key"] not in self._nearby.setdefault(nearby, []):
            self._nearby[nearby].append(entry["key"])

    def _checked(self, line: bytes, where: str) -> dict[str, Any]:
        """The entry of a line. Raises ConfigError if it is none, or if it was changed since."""
        try:
            entry = json.loads(line, parse_constant=_no_constants)
            sound = isinstance(entry["place"], dict) and (_is_recording(entry) or entry["key"] in self._entries)
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise ConfigError(f"{where} is no recording; remove the line or use another cassette") from error
        if not sound:
            raise ConfigError(f"{where} names a recording that does not stand above it; remove the line")
        return entry

    def entries(self) -> list[dict[str, Any]]:
        """Everything recorded, in order."""
        self.refresh()
        return list(self._entries.values())

    def find(self, request: Mapping[str, Any]) -> Reply | None:
        """The reply recorded for exactly this request; the first one, if it was recorded twice."""
        self.refresh()
        entry = self._entries.get(request_key(request))
        return None if entry is None else _reply(entry, "recorded")

    def find_nearby(self, request: Mapping[str, Any], place: Mapping[str, Any], tolerance: float) -> Reply | None:
        """The reply at the same place to a request whose numbers differ by ``tolerance`` at most."""
        keys = self._nearby.get(nearby_key(request, place) or "", [])
        offs = [(largest_difference(self._entries[key]["request"], request), key) for key in keys]
        off, key = min(offs, default=(float("inf"), ""))
        return _reply(self._entries[key], "recorded nearby") if off <= tolerance else None

    def describe_nearest(self, request: Mapping[str, Any], place: Mapping[str, Any]) -> str:
        """How a request that was not found differs from the recording most like it, in words."""
        if not self._entries:
            return f"{self.path} holds no recording"
        entry = max(self._entries.values(), key=lambda known: _likeness(known, request, place))
        return f"the nearest recording differs: {describe_difference(entry['request'], request)}"

    def add_place(self, request: Mapping[str, Any], place: Mapping[str, Any]) -> None:
        """Note that a recorded request was asked at another place too, if that is not known yet."""
        key, nearby = request_key(request), nearby_key(request, place)
        if nearby is not None and key not in self._nearby.get(nearby, []):
            append_line(self.path, {"key": key, "place": dict(place)})

    def add(self, request: Mapping[str, Any], place: Mapping[str, Any], reply: Reply) -> None:
        """Append a pair; it is on disk when this returns. Raises LLMError if it holds a secret."""
        content = {name: value for name, value in asdict(reply).items() if name in _REPLY}
        recorded = datetime.now(UTC).date().isoformat()
        entry = {
            "key": request_key(request),
            "recorded": recorded,
            "request": dict(request),
            "place": dict(place),
            "reply": content,
        }
        append_line(self.path, entry)
        self.refresh()


def _likeness(entry: Mapping[str, Any], request: Mapping[str, Any], place: Mapping[str, Any]) -> tuple[float, ...]:
    """Same place first, then as much as possible of the last message and of the prompt."""
    known = entry["request"]
    alike = sum(entry["place"].get(name) == value for name, value in place.items())
    same = sum(known[name] == request[name] for name in ("model", "params", "sample"))
    texts = [str(r["messages"][-1].get("content"))[-300:] if r["messages"] else "" for r in (known, request)]
    return float(alike), float(same), SequenceMatcher(None, texts[0], texts[1]).quick_ratio()


def _reply(entry: Mapping[str, Any], origin: str) -> Reply:
    return replace(Reply(**entry["reply"]), origin=origin)


def _is_recording(entry: Mapping[str, Any]) -> bool:
    if entry.keys() == {"key", "place"}:
        return False
    request, reply = entry["request"], entry["reply"]
    sound = request["v"] == REQUEST_VERSION and isinstance(reply["text"], str) and reply.keys() <= _REPLY
    if not sound or request_key(request) != entry["key"]:
        raise ValueError("it was changed, or made by another version of PolyFold")
    return True


def _no_constants(name: str) -> float:
    raise ValueError(f"{name} is no number")


def recorded_lines(path: Path, begin: int = 0, growing: bool = True) -> Iterator[tuple[bytes, int]]:
    """The lines of a file of requests or replies, as :meth:`polyfold.logs.JsonLines.lines` gives them.

    Raises:
        ConfigError: if the file or a line is far too long.
    """
    if path.exists() and path.stat().st_size > LARGEST_FILE:
        raise ConfigError(f"{path} is larger than {LARGEST_FILE / 1e9:.0f} GB; split it")
    return JsonLines(path, LONGEST_LINE).lines(begin, growing)


def refuse_secrets(content: Any) -> None:
    """Refuse data that holds a secret. Raises LLMError."""
    if contains_secret(json.dumps(content, ensure_ascii=False, allow_nan=False)):
        raise LLMError(
            "the conversation holds a key of this environment, or what looks like one, and is not recorded; take it "
            "out of the instruction or prompt"
        )


def append_line(path: Path, content: Mapping[str, Any]) -> None:
    """Append data as one line, whole or not at all, whoever else is appending.

    Raises:
        LLMError: if it holds a secret.
        ConfigError: if it is too long, or the file can't be written.
    """
    refuse_secrets(content)
    JsonLines(path, LONGEST_LINE).append(content)


def recorded_models(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """The models that entries were recorded from, in order of appearance."""
    return list(dict.fromkeys(entry["request"]["model"] for entry in entries))
