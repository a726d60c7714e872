"""Measure what a user waits for: ``python -m experiments.benchmarks.speed``.

Seconds of whole commands, start-up included.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time

import numpy as np

COMMANDS = {
    "import polyfold": (["-c", "import polyfold"], 0.3),
    "polyfold --help": (["-m", "polyfold", "--help"], 0.5),
    "polyfold plugins": (["-m", "polyfold", "plugins"], 0.6),
    "square, half": (["-m", "polyfold", "fold", "fold the square in half", "--garment", "square"], 5.0),
    "t-shirt, block (3 folds)": (["-m", "polyfold", "fold", "fold the t-shirt into a rectangular block"], 12.0),
}
"""Name -> arguments of the interpreter, and the seconds it should take at most."""


def main(arguments: list[str] | None = None) -> None:
    """Time every command after one warm-up and print the table."""
    parser = argparse.ArgumentParser(description="Measure what a user waits for.")
    parser.add_argument("--n", type=int, default=5, help="runs of each command (default: 5)")
    runs = parser.parse_args(arguments).n
    print("| command | n | median [s] | slowest [s] | bound [s] |\n|---|---|---|---|---|")
    for name, (command, bound) in COMMANDS.items():
        with tempfile.TemporaryDirectory() as out:
            command = [sys.executable, *command, *(["--out", out] if "fold" in command else [])]
            _seconds(command)
            seconds = [_seconds(command) for _ in range(runs)]
        print(f"| {name} | {runs} | {np.median(seconds):.2f} | {max(seconds):.2f} | {bound} |", flush=True)


def _seconds(command: list[str]) -> float:
    clock = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - clock


if __name__ == "__main__":
    main()
