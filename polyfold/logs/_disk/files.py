"""Files of a run directory: written whole or not at all, with names that every file system takes."""

from __future__ import annotations

import hashlib
import os
import re
from contextlib import suppress
from pathlib import Path


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file so that a kill or a full disk leaves either the old content or the new; links stay links."""
    content = content.encode("utf-8") if isinstance(content, str) else content
    target = path.resolve()
    if target.exists() and not (target.is_file() or target.is_dir()):  # such as /dev/stdout
        target.write_bytes(content)
        return
    scratch = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        scratch.write_bytes(content)
        scratch.replace(target)
    except OSError as error:
        with suppress(OSError):
            scratch.unlink(missing_ok=True)
        error.filename, error.filename2 = str(path), None  # what was asked for, and not the scratch file
        raise


def picture_path(key: str) -> str:
    """Where an episode's picture lies in its run directory, as a relative path that every file system takes."""
    readable = re.sub(r"[^A-Za-z0-9.-]+", "_", key).strip("._")[:80]
    return f"pictures/{readable}-{hashlib.sha256(key.encode()).hexdigest()[:8]}.webp"
