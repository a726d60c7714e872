"""Demonstrations on disk: ``dataset.json`` and a shard for each, whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold_baselines.demos.cloths import CLOTH, Cloth
from polyfold_baselines.demos.demonstrating import Arrays, DemoPlan, unpacked

SCHEMA = 2
READ = (1, SCHEMA)
"""Versions of the format; the first kept no particles of random drags."""


class DemoFolder:
    """A folder that demonstrations are written to.

    Raises:
        ConfigError: if it holds others.
    """

    def __init__(self, path: Path, plan: DemoPlan) -> None:
        self.path, self._plan = path, plan
        self._shards = path / "shards"
        self._shards.mkdir(parents=True, exist_ok=True)
        held = _description(path) if (path / "dataset.json").exists() else None
        if held is not None and held["plan"] != plan.model_dump(mode="json"):
            raise ConfigError(f"{path} holds other demonstrations; choose another folder, or repeat its settings")
        if held is not None and held["schema_version"] < SCHEMA and plan.agent == "random-drags":
            raise ConfigError(f"{path} was begun by a version that kept less of random drags; choose another folder")
        if held is None:
            self._describe({})

    def jobs(self) -> set[int]:
        """Which are there."""
        return {int(file.stem) for file in self._shards.glob("*.npz")}

    def write(self, job: int, arrays: Arrays) -> None:
        """Write one."""
        part = self._shards / f"{job:05d}.part{os.getpid()}"
        with part.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # pyright: ignore[reportArgumentType]
        part.replace(self._shards / f"{job:05d}.npz")

    def finish(self) -> dict[str, Any]:
        """Count what is there, and say by a hash which it is."""
        for part in self._shards.glob("*.part*"):
            part.unlink()
        counts = {"demonstrations": 0, "folds": 0, "broken off": 0}
        whole = hashlib.sha256()
        for file in sorted(self._shards.glob("*.npz")):
            arrays = _read(file)
            folds = len(arrays.get("step", ()))
            counts["folds"] += folds
            counts["demonstrations" if folds else "broken off"] += 1
            for name, values in sorted(arrays.items()):
                whole.update(json.dumps([file.stem, name, list(values.shape)]).encode())
                whole.update(np.ascontiguousarray(values).tobytes())
        return self._describe({"counts": counts, "hash": whole.hexdigest()})

    def _describe(self, found: dict[str, Any]) -> dict[str, Any]:
        told = {"schema_version": SCHEMA, "plan": self._plan.model_dump(mode="json"), **found}
        part = self.path / "dataset.json.part"
        part.write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
        part.replace(self.path / "dataset.json")
        return told


@dataclass(frozen=True, eq=False)
class Demos:
    """Demonstrations that were read.

    Attributes:
        plan: what was demonstrated.
        hash: of all that they hold.
        columns: every fold's row, as :func:`polyfold_baselines.demos.demonstrating.demonstrate` names them; ``end`` is
            the row of the last fold of the same demonstration.
        path: the folder.
    """

    plan: DemoPlan
    hash: str
    columns: Arrays
    path: Path

    @classmethod
    def read(cls, path: str | Path) -> Demos:
        """Read a folder. Raises ConfigError if it holds none, or they are not finished or damaged."""
        path = Path(path)
        told = _description(path)
        if "hash" not in told:
            raise ConfigError(f"the demonstrations in {path} are not finished; run the same 'polyfold demos' again")
        shards = [arrays for arrays in _shards(path, without=CLOTH) if len(arrays.get("step", ()))]
        if not shards:
            raise ConfigError(f"{path} holds no demonstration that came to its end; collect more")
        columns = {name: np.concatenate([shard[name] for shard in shards]) for name in shards[0]}
        lengths = np.array([len(shard["step"]) for shard in shards])
        columns["end"] = np.repeat(np.cumsum(lengths) - 1, lengths)
        return cls(DemoPlan(**told["plan"]), told["hash"], columns, path)

    def with_arms(self, row: str, arms: int) -> Demos:
        """These demonstrations. Raises ConfigError if they have other arms than the row that is to learn from them."""
        if self.plan.arms != arms:
            raise ConfigError(
                f"{row} folds with {arms} arm{'s' * (arms > 1)}, and the demonstrations in {self.path} have "
                f"{self.plan.arms}; make some with 'polyfold demos --arms {arms}', or choose another baseline"
            )
        return self

    def __len__(self) -> int:
        return len(self.columns["step"])

    @cached_property
    def masks(self) -> NDArray[np.bool_]:
        """The cloth before each fold, shape (N, SIDE, SIDE)."""
        return unpacked(self.columns["mask"])

    def cloths(self) -> Iterator[Cloth]:
        """The cloth of each demonstration, read from disk one by one. Raises ConfigError if none was kept."""
        first = 0
        for shard in _shards(self.path):
            if count := len(shard.get("step", ())):
                if "particles" not in shard:
                    raise ConfigError(
                        f"{self.path} holds no particles; drag anew with "
                        "'polyfold demos --agent random-drags --arms 1', into another folder"
                    )
                yield Cloth.of(slice(first, first + count), shard)
                first += count


def _shards(path: Path, without: Collection[str] = ()) -> Iterator[Arrays]:
    for file in sorted((path / "shards").glob("*.npz")):
        yield _read(file, without)


def _read(file: Path, without: Collection[str] = ()) -> Arrays:
    try:
        with np.load(file, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files if name not in without}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise ConfigError(f"{file} is damaged ({error}); remove it and run the same 'polyfold demos' again") from error


def _description(path: Path) -> dict[str, Any]:
    file = path / "dataset.json"
    try:
        told = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(told, dict) or told.get("schema_version") not in READ:
            raise ValueError(f"no schema_version of {READ}")
        DemoPlan(**told["plan"])
    except OSError as error:
        raise ConfigError(f"there are no demonstrations in {path}; make some with 'polyfold demos --out'") from error
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ConfigError(f"{file} describes no demonstrations ({error}); choose another folder") from error
    return told
