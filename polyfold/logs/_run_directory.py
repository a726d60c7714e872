"""Run directories: append-only, one finished episode a line, safe to kill at any moment and to resume.

``run.json`` says what the run is; ``episodes.jsonl`` holds one finished episode a line, appended and flushed to disk. A
last line that a kill cut in half is dropped when the directory is opened again.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError

SCHEMA_VERSION = 1


def versions() -> dict[str, str]:
    """Versions that a result depends on."""
    found = {"python": platform.python_version()}
    for package in ("polyfold", "numpy", "scipy", "numba", "opencv-python-headless", "shapely", "torch"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file so that a kill leaves either the old content or the new."""
    scratch = path.with_name(f".{path.name}.{os.getpid()}")
    scratch.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    scratch.replace(path)


def picture_path(key: str) -> str:
    """Where an episode's picture lies in its run directory, as a relative path that every file system takes."""
    readable = re.sub(r"[^A-Za-z0-9.-]+", "_", key).strip("._")[:80]
    return f"pictures/{readable}-{hashlib.sha256(key.encode()).hexdigest()[:8]}.webp"


class RunDirectory:
    """A directory of results that belong to one configuration.

    Args:
        path: the directory; created if needed.
        config: plain data that defines the run; a directory made with another one is refused.

    Raises:
        ConfigError: if the directory belongs to another configuration or an unknown schema version.
    """

    def __init__(self, path: str | Path, config: Mapping[str, Any]) -> None:
        self.path = Path(path)
        self.path.mkdir(parents=True, exist_ok=True)
        self._episodes = self.path / "episodes.jsonl"
        self._claim(json.loads(json.dumps(config)))
        self._drop_half_written_line()

    def _claim(self, config: dict[str, Any]) -> None:
        description = self.path / "run.json"
        if not description.exists():
            content = {"schema_version": SCHEMA_VERSION, "config": config, "versions": versions()}
            write_atomically(description, json.dumps(content, indent=2) + "\n")
            return
        found = json.loads(description.read_text("utf-8"))
        if found.get("schema_version") != SCHEMA_VERSION:
            raise ConfigError(
                f"{description} has schema version {found.get('schema_version')}, this is {SCHEMA_VERSION}; "
                "use the polyfold version that made it, or another directory"
            )
        if found["config"] != config:
            raise ConfigError(
                f"{self.path} holds a run with another configuration ({_difference(found['config'], config)}); "
                "use another directory, or the old configuration"
            )

    def _drop_half_written_line(self) -> None:
        if not self._episodes.exists():
            return
        content = self._episodes.read_bytes()
        complete = content[: content.rfind(b"\n") + 1]
        if len(complete) != len(content):
            with self._episodes.open("r+b") as file:
                file.truncate(len(complete))

    def append(self, key: str, record: Mapping[str, Any]) -> None:
        """Add a finished episode under a unique key; it is on disk when this returns."""
        with self._episodes.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"key": key, **record}) + "\n")
            file.flush()
            os.fsync(file.fileno())

    def episodes(self) -> dict[str, dict[str, Any]]:
        """Finished episodes by key, in the order they finished."""
        return {record["key"]: record for record in read_episodes(self.path)}


def read_episodes(path: str | Path) -> list[dict[str, Any]]:
    """The finished episodes of a run directory, the last try of each.

    The directory may be running still: a half-written last line is left out.
    """
    episodes = Path(path) / "episodes.jsonl"
    if not episodes.exists():
        return []
    records = [json.loads(line) for line in episodes.read_text("utf-8").split("\n")[:-1]]
    return list({record["key"]: record for record in records}.values())


def _difference(old: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    changed = sorted(key for key in {*old, *new} if old.get(key) != new.get(key))
    return "; ".join(f"{key}: {old.get(key)!r} there, {new.get(key)!r} here" for key in changed)
