"""How studies run: ``python -m experiments.benchmarks.running``. Workers, engines, and SIGKILL at random moments.

The study is run by one worker, by two and on a Dask cluster of two, each with an empty cache of references, and once
more while it is killed at random moments and started again. All must find the same to the bit.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from polyfold.logs import read_episodes

TIMES = {"seconds", "calls", "started", "finished", "peak_memory_mb", "picture"}
"""What may differ between runs: times, memory, and where a picture lies."""

Record = dict[str, Any]


def main(arguments: list[str] | None = None) -> None:
    """Run the study in every way and print the table."""
    parser = argparse.ArgumentParser(description="Run a study in every way and compare what comes out.")
    parser.add_argument("config", nargs="?", default="experiments/smoke.toml", help="default: experiments/smoke.toml")
    parser.add_argument("--kills", type=int, default=10, help="default: 10")
    parser.add_argument("--seed", type=int, default=0, help="of the moments of the kills (default: 0)")
    chosen = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        ways = {
            "one worker": ["--workers", "1"],
            "two workers": ["--workers", "2"],
            "Dask, two workers": ["--workers", "2", "--engine", "dask"],
        }
        print("| run | seconds | episodes | distinct | same as one worker |\n|---|---|---|---|---|")
        first: list[Record] | None = None
        longest = 0.0
        for name, options in ways.items():
            out = Path(folder) / name.replace(" ", "-")
            seconds = _timed(_command(chosen.config, out, *options), out)
            longest = max(longest, seconds)
            first = first or _scores(out)
            _print_row(name, seconds, out, first)
        assert first is not None
        out = Path(folder) / "killed"
        moments = random.Random(chosen.seed)
        clock = time.perf_counter()
        killed = sum(
            _killed(_command(chosen.config, out), out, moments.uniform(0.02, 2.0) * longest / chosen.kills)
            for _ in range(chosen.kills)
        )
        _timed(_command(chosen.config, out), out)
        _print_row(f"killed {killed} times and resumed", time.perf_counter() - clock, out, first)


def _print_row(name: str, seconds: float, out: Path, first: list[Record]) -> None:
    found = _scores(out)
    distinct = len({record["key"] for record in found})
    print(f"| {name} | {seconds:.0f} | {len(found)} | {distinct} | {'yes' if found == first else 'no'} |", flush=True)


def _command(config: str, out: Path, *options: str) -> list[str]:
    return [sys.executable, "-m", "polyfold", "evaluate", config, "--out", str(out), "--pictures", "none", *options]


def _environment(out: Path) -> dict[str, str]:
    return {**os.environ, "POLYFOLD_CACHE": str(out) + "-cache"}


def _timed(command: list[str], out: Path) -> float:
    clock = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, env=_environment(out))
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed: {done.stderr[-2000:]}")
    return time.perf_counter() - clock


def _killed(command: list[str], out: Path, seconds: float) -> bool:
    """Start the command and kill it after that long; whether it still ran."""
    quiet = subprocess.DEVNULL
    child = subprocess.Popen(command, stdout=quiet, stderr=quiet, env=_environment(out))
    try:
        child.wait(seconds)
    except subprocess.TimeoutExpired:
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
        return True
    return False


def _scores(out: Path) -> list[Record]:
    """What every way must agree on: the records without times."""
    records = [record.model_dump(mode="json", exclude=TIMES) for record in read_episodes(out)]
    for record in records:
        record["steps"] = [{**step, "seconds": None} for step in record["steps"]]
    return sorted(records, key=lambda record: json.dumps(record["key"]))


if __name__ == "__main__":
    main()
