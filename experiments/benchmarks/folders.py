"""Folders that two processes share, and folders that are damaged: ``python -m experiments.benchmarks.folders``.

Pairs of processes begin the same work in one new folder, at nearly the same time: a study, a collection, a training.
One must finish it, the other do so too or say that the folder is in use; and the folder must hold what it holds where
nobody disturbed. Then finished folders are damaged, a file of each, and the same command runs once more: it must end in
the undisturbed folder again, or say in one line what is wrong and leave all other files as they are.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from safetensors.numpy import load_file

from experiments.benchmarks.running import TIMES
from polyfold.logs import read_episodes

STUDY = """
name = "folders"
tasks = ["square-corner-*", "rectangle-half-*"]
first_seed = 2000
edge_length = 0.03
base = { agent = "noop" }
"""
TRAINING = """
data = [DATA]
epochs = 6
batch = 8
[network]
base = 4
levels = 2
"""
COLLECTION = ["--folds", "24", "--seeds", "2000-2001", "--edge-length", "0.05", "--mix", "uniform=1"]
PICTURES = {".webp", ".png"}
"""Files that nothing is read from."""
WRONG = ("ENDED OTHERWISE", "LOST OR DOUBLED", "TRACEBACK", "OTHER CONTENT", "LOST")
"""Outcomes that must not be."""
HEAD_START = 1.5
"""The second process of a pair begins up to so long after the first [s]."""


@dataclass(frozen=True)
class Work:
    """Something that fills a folder.

    Attributes:
        name: what the table calls it.
        arguments: of ``polyfold``, where the folder is DIR.
        content: what a finished folder holds, of which nothing may differ between runs.
    """

    name: str
    arguments: tuple[str, ...]
    content: Callable[[Path], object]

    def begin(self, out: Path) -> subprocess.Popen[str]:
        """Start it in a process of its own."""
        words = [word.replace("DIR", str(out)) for word in self.arguments]
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "polyfold", *words]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment)


def main(arguments: list[str] | None = None) -> int:
    """Race, damage, and print both tables; returns 1 if anything was lost, doubled or other than it should be."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.folders", description=__doc__)
    parser.add_argument("--pairs", type=int, default=20, help="of processes on one folder (default: 20)")
    parser.add_argument("--damaged", type=int, default=20, help="folders (default: 20)")
    parser.add_argument("--seed", type=int, default=0, help="of what happens to them (default: 0)")
    chosen = parser.parse_args(arguments)
    rng = random.Random(chosen.seed)
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        works, whole = _undisturbed(root)
        races = [_race(works[k % len(works)], whole, root / f"race-{k}", rng) for k in range(chosen.pairs)]
        _print("pairs of processes on one folder", Counter(races))
        print()
        harms = [_harm(works[k % len(works)], whole, root / f"damaged-{k}", rng) for k in range(chosen.damaged)]
        _print("damaged folders", Counter(harms))
    return int(any(verdict in WRONG for _, verdict in [*races, *harms]))


def _undisturbed(root: Path) -> tuple[list[Work], dict[str, Path]]:
    """The kinds of work, and a folder that each has filled alone."""
    study, training = root / "study.toml", root / "training.toml"
    study.write_text(STUDY, "utf-8")
    training.write_text(TRAINING.replace("DATA", json.dumps(str(root / "whole-collection"))), "utf-8")
    works = [
        Work("study", ("evaluate", str(study), "--out", "DIR"), _episodes),
        Work("collection", ("collect", "--out", "DIR", *COLLECTION), _shards),
        Work("training", ("train", str(training), "--out", "DIR", "--device", "cpu"), _weights),
    ]
    whole = {}
    for work in works:
        whole[work.name] = root / f"whole-{work.name}"
        process = work.begin(whole[work.name])
        told = process.communicate()[1]
        if process.returncode != 0:
            raise SystemExit(f"{work.name} fails even undisturbed: {told}")
    return works, whole


def _race(work: Work, whole: dict[str, Path], out: Path, rng: random.Random) -> tuple[str, str]:
    first = work.begin(out)
    time.sleep(rng.uniform(0.0, HEAD_START))
    second = work.begin(out)
    ended = [(process.communicate()[1], process.returncode) for process in (first, second)]
    finished = sum(status == 0 for _, status in ended)
    refused = sum(status != 0 and "is in use by process" in told for told, status in ended)
    if finished + refused < 2:
        return work.name, "ENDED OTHERWISE"
    if finished == 0 or work.content(out) != work.content(whole[work.name]):
        return work.name, "LOST OR DOUBLED"
    return work.name, "one finished, one was told" if refused else "both finished, each item once"


def _harm(work: Work, whole: dict[str, Path], out: Path, rng: random.Random) -> tuple[str, str]:
    shutil.copytree(whole[work.name], out)
    files = sorted(file for file in out.rglob("*") if file.is_file() and _matters(file))
    file = rng.choice(files)
    how = rng.choice(list(HARMS))
    HARMS[how](file, rng)
    others = {other: _digest(other) for other in files if other != file}
    process = work.begin(out)
    told = process.communicate()[1]
    what = f"{work.name}: {file.name if file.suffix != '.npz' else 'a shard'} {how}"
    if "Traceback" in told:
        return what, "TRACEBACK"
    if process.returncode == 0:
        return what, "whole again" if work.content(out) == work.content(whole[work.name]) else "OTHER CONTENT"
    kept = all(other.exists() and _digest(other) == digest for other, digest in others.items())
    return what, "told, the others kept" if kept else "LOST"


def _matters(file: Path) -> bool:
    """Whether anything is read from a file; locks are empty."""
    return file.suffix not in PICTURES and file.stat().st_size > 1


def _flip(file: Path, rng: random.Random) -> None:
    content = bytearray(file.read_bytes())
    content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    file.write_bytes(bytes(content))


def _cut(file: Path, rng: random.Random) -> None:
    content = file.read_bytes()
    file.write_bytes(content[: rng.randrange(1, len(content))])


HARMS: dict[str, Callable[[Path, random.Random], object]] = {
    "with one bit flipped": _flip,
    "cut off": _cut,
    "emptied": lambda file, _: file.write_bytes(b""),
    "removed": lambda file, _: file.unlink(),
    "with a foreign line at its end": lambda file, _: file.write_bytes(file.read_bytes() + b"what is this?\n"),
    "with all of it twice": lambda file, _: file.write_bytes(2 * file.read_bytes()),
}


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _episodes(out: Path) -> object:
    records = [record.model_dump(exclude=TIMES) for record in read_episodes(out)]
    lines = (out / "episodes.jsonl").read_bytes().count(b"\n")
    return lines, sorted(records, key=lambda record: str(record["key"]))


def _shards(out: Path) -> object:
    held = {}
    for shard in sorted((out / "shards").glob("*.npz")):
        with np.load(shard, allow_pickle=False) as arrays:
            held[shard.name] = {name: hashlib.sha256(arrays[name].tobytes()).hexdigest() for name in arrays}
    return held


def _weights(out: Path) -> object:
    tensors = load_file(out / "weights.safetensors")
    return {name: hashlib.sha256(tensor.tobytes()).hexdigest() for name, tensor in tensors.items()}


def _print(what: str, counts: Counter[tuple[str, str]]) -> None:
    print(f"| {what} | outcome | n |\n|---|---|---|")
    for (name, verdict), count in sorted(counts.items()):
        print(f"| {name} | {verdict} | {count} |")


if __name__ == "__main__":
    sys.exit(main())
