"""Digests of code and files, and the state of the checkouts that they are used from."""

from __future__ import annotations

import hashlib
import inspect
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from polyfold.logs._fingerprint import UNREADABLE, GitState
from polyfold.plugins._registry.carrying import SOURCE

SOURCES = {".py", ".toml", ".txt", ".json", ".csv", ".md"}
"""Endings of files that count as a plugin's source."""


@dataclass(frozen=True)
class Source:
    """The code of a component.

    Attributes:
        name: of the package it belongs to; of the class where that is all there is.
        digest: SHA-256.
        folder: of the package; None for a lone module or a class of a notebook.
    """

    name: str
    digest: str
    folder: Path | None


def source_of(target: type | str) -> Source:
    """Where a component is defined: its class, or ``"package.module:Class"``."""
    module = target.partition(":")[0] if isinstance(target, str) else target.__module__
    package = module.partition(".")[0]
    spec = None if package == "__main__" else find_spec(package)
    if spec is not None and spec.submodule_search_locations:
        folder = Path(next(iter(spec.submodule_search_locations)))
        return Source(package, digest_of_folder(folder), folder)
    if spec is not None and spec.origin:
        return Source(package, digest_of_file(Path(spec.origin)), None)
    if isinstance(target, str):
        return Source(package, UNREADABLE, None)
    return Source(f"{module}.{target.__qualname__}", _digest_of_class(target), None)


def _digest_of_class(target: type) -> str:
    """Of a class typed into a notebook or a script."""
    if carried := getattr(target, SOURCE, None):
        return hashlib.sha256(carried.encode()).hexdigest()
    try:
        return hashlib.sha256(inspect.getsource(target).encode()).hexdigest()
    except (OSError, TypeError):
        return UNREADABLE


def digest_of(path: Path) -> str:
    """SHA-256 of a file, or of a folder's sources."""
    return digest_of_folder(path) if path.is_dir() else digest_of_file(path)


def digest_of_folder(folder: Path) -> str:
    """SHA-256 of a folder's sources, with their names."""
    passed_over = {"__pycache__", ".ipynb_checkpoints"}
    files = sorted(p for p in folder.rglob("*") if p.suffix in SOURCES and passed_over.isdisjoint(p.parts))
    digest = hashlib.sha256()
    for path in files:
        digest.update(str(path.relative_to(folder)).encode())
        digest.update(digest_of_file(path).encode())
    return digest.hexdigest()


def digest_of_file(path: Path) -> str:
    """SHA-256 of a file."""
    try:
        seen = path.stat()
    except OSError:
        return UNREADABLE
    return _digest(path, seen.st_mtime_ns, seen.st_size)


@lru_cache(maxsize=4096)
def _digest(path: Path, _modified: int, _size: int) -> str:
    """Read once for as long as its time of modification and its size stay."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def git_states(folders: Mapping[str, Path]) -> dict[str, GitState]:
    """The state of each checkout, under the first package that is used from it; none for installed packages."""
    found: dict[str, GitState] = {}
    seen: set[Path] = set()
    for name, folder in folders.items():
        checkout = next((parent for parent in folder.parents if (parent / ".git").exists()), None)
        # A package may be installed into an environment that lies inside of somebody's checkout.
        if checkout is None or checkout in seen or not _git(checkout, "ls-files", "--", str(folder)):
            continue
        seen.add(checkout)
        state = _git_state(checkout)
        if state is not None:
            found[name] = state
    return found


def _git_state(checkout: Path) -> GitState | None:
    commit = _git(checkout, "rev-parse", "HEAD")
    changed = _git(checkout, "status", "--porcelain", "--untracked-files=no")
    return GitState(commit=commit, dirty=bool(changed)) if commit else None


def _git(checkout: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(checkout), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
