"""What installing costs: ``python -m experiments.benchmarks.install``, with the versions of ``constraints.txt``.

For the default and each extra: seconds from an empty environment without pip's cache, the environment's size before and
after, with and without byte code. Of the default also how long the first fold after the install takes, and the same one
again. Prints Markdown.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Sequence
from pathlib import Path

PROJECT = Path(__file__).parents[2]
FOLD = ("fold", "fold it in half", "--garment", "tshirt", "--seed", "0")
DEFAULT, DEVELOPERS = "default", ("test", "lint")


def main() -> None:
    """Install each, and print."""
    from tqdm import tqdm

    extras = tomllib.loads((PROJECT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    lines = ["| extra | seconds | MB | without byte code | packages |", "|---|---|---|---|---|"]
    folds: list[float] = []
    for extra in tqdm([DEFAULT, *(extra for extra in extras if extra not in DEVELOPERS)], file=sys.stderr):
        with tempfile.TemporaryDirectory() as folder:
            lines.append(_installed(extra, Path(folder)))
            if extra == DEFAULT:
                folds = [_seconds([str(_bin(folder) / "polyfold"), *FOLD], folder) for _ in range(3)]
    print("\n".join(lines))
    print(f"\nThe first fold after the install takes {folds[0]:.1f} s, the same one again {min(folds[1:]):.1f} s.")


def _installed(extra: str, folder: Path) -> str:
    """Install the project with one extra into an empty environment; the table's row."""
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    before = _megabytes(folder)
    what = str(PROJECT) if extra == DEFAULT else f"{PROJECT}[{extra}]"
    pip = [str(_bin(folder) / "python"), "-m", "pip", "install", "--quiet", "--no-cache-dir"]
    seconds = _seconds([*pip, "--constraint", str(PROJECT / "constraints.txt"), what], folder)
    packages = len([*folder.rglob("*.dist-info")]) - 2  # pip and setuptools were there
    whole, code = _megabytes(folder), _megabytes(folder, "*.pyc")
    return f"| {extra} | {seconds:.0f} | {whole - before:.0f} | {whole - before - code:.0f} | {packages} |"


def _bin(folder: str | Path) -> Path:
    return Path(folder) / "venv" / ("Scripts" if os.name == "nt" else "bin")


def _seconds(command: Sequence[str], folder: str | Path) -> float:
    clock = time.perf_counter()
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return time.perf_counter() - clock


def _megabytes(folder: Path, pattern: str = "*") -> float:
    return sum(file.stat().st_size for file in folder.rglob(pattern) if file.is_file() and not file.is_symlink()) / 1e6


if __name__ == "__main__":
    main()
