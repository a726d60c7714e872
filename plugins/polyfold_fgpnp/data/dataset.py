"""The data set of folds: one folder with ``dataset.json`` and shards, written by ``polyfold collect``.

``dataset.json`` holds the schema version, the parameters, the counts and, once complete, a hash over all shards.
A shard ``shards/00042.npz`` (no pickle) holds what one job found. Per state, shape (S, ...):

* ``mask``: the cloth, packed bits of shape (H, W); ``line``: fold line x0, y0, x1, y1 [px]; ``line_kind``: index into
  :data:`polyfold_fgpnp.policies.lines.LINE_KINDS`; ``garment_seed``; ``folds_before``; ``pixels_per_metre``;
* ``idle_chamfer_px``, ``travel_mm``: how far the untouched cloth is from the goal, by contour and by particles.

Per trial, shape (T, ...):

* ``trial_state``: index of its state within the shard; ``recipe``: index into
  :data:`polyfold_fgpnp.data.trials.RECIPES`;
* ``first``, ``second``: contour points [px]; ``picks``: where the arms picked [px], (2, 2), NaN for no second arm;
* ``chamfer_px``, ``iou``, ``flap_mm``, ``rest_mm``: the outcome (:class:`polyfold_fgpnp.data.outcomes.Outcome`);
* ``diverged``: the simulation failed and there is no outcome; ``result``: the resulting mask, packed bits.
"""

from __future__ import annotations

import hashlib
import json
import os
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine, contour_of
from polyfold.types import Scene
from polyfold_fgpnp.data.outcomes import contour_reward, particle_reward
from polyfold_fgpnp.data.packing import read_packed, read_packed_description, write_packed
from polyfold_fgpnp.data.trials import RECIPES

SCHEMA = 2

IMAGE = (400, 400)
"""Height and width of all masks [px]."""

Description = dict[str, Any]


class DatasetFolder:
    """A data set on disk that is being written, shard by shard; a shard is there whole or not at all.

    Args:
        path: the folder; made if needed.
        parameters: plain data that decides every shard.

    Raises:
        ConfigError: if the folder holds a data set with other parameters.
    """

    def __init__(self, path: str | Path, parameters: Mapping[str, Any]) -> None:
        self.path = Path(path)
        self._parameters = json.loads(json.dumps(parameters))
        (self.path / "shards").mkdir(parents=True, exist_ok=True)
        if (self.path / "dataset.json").exists():
            self._found = _read_description(self.path)
            self._refuse_others(self._found["parameters"])
        else:
            self._found = self._describe({"complete": False})

    def jobs(self) -> set[int]:
        """Jobs whose shards are there."""
        return {int(path.stem) for path in (self.path / "shards").glob("*.npz")}

    def set_damage_aside(self) -> None:
        """Put shards that can't be read beside the others, with a warning, so that their jobs run again."""
        for file in sorted((self.path / "shards").glob("*.npz")):
            try:
                _shard(file)
            except ConfigError as error:
                beside = file.with_suffix(".damaged")
                file.replace(beside)
                warnings.warn(f"{error}; it is kept as {beside.name} and collected again", stacklevel=3)

    def write(self, job: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Write a job's shard; a data set that was finished is being extended then, and no longer complete.

        Args:
            job: which.
            arrays: its columns, of the shapes that the module's docstring names.
        """
        if self._found["complete"]:
            before = {name: self._found[name] for name in ("counts", "hash")}
            self._found = self._describe({"complete": False, **before})
        target = self.path / "shards" / f"{job:05d}.npz"
        part = target.with_suffix(f".part{os.getpid()}")
        with part.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # pyright: ignore[reportArgumentType]  (none is called allow_pickle)
        part.replace(target)

    def finish(self) -> Description:
        """Write counts and hash into ``dataset.json`` and return it; leftovers of killed runs are removed.

        Raises:
            ConfigError: if it was finished before with as many folds, and others.
        """
        for part in (self.path / "shards").glob("*.part*"):
            part.unlink()
        states = trials = diverged = 0
        for shard in _shards(self.path):
            states += len(shard["mask"])
            trials += len(shard["recipe"])
            diverged += int(shard["diverged"].sum())
        counts = {"states": states, "folds": trials, "diverged": diverged}
        found = {"counts": counts, "hash": _hash(self.path)}
        if self._found.get("counts") == counts and self._found["hash"] != found["hash"]:
            raise _changed(self.path)
        self._found = self._describe({"complete": True, **found})
        return self._found

    def _describe(self, found: Mapping[str, Any]) -> Description:
        description = {"schema_version": SCHEMA, "parameters": self._parameters, **found}
        part = self.path / "dataset.json.part"
        part.write_text(json.dumps(description, indent=2) + "\n", "utf-8")
        part.replace(self.path / "dataset.json")
        return description

    def _refuse_others(self, there: Mapping[str, Any]) -> None:
        keys = sorted(there.keys() | self._parameters.keys())
        other = [key for key in keys if there.get(key) != self._parameters.get(key)]
        if other:
            shown = ", ".join(f"{key} {there.get(key)!r} there, {self._parameters.get(key)!r} asked" for key in other)
            raise ConfigError(f"{self.path} holds a data set with other parameters ({shown}); choose another folder")


@dataclass(frozen=True, eq=False)
class Dataset:
    """A data set in memory: the arrays of all shards, with ``trial_state`` indexing all states.

    Attributes:
        description: what ``dataset.json`` says.
        columns: name -> array, as in the module's docstring.
    """

    description: Description
    columns: Mapping[str, NDArray[Any]]

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    @property
    def states(self) -> int:
        """Number of states."""
        return len(self["mask"])

    @property
    def folds(self) -> int:
        """Number of folds tried, diverged ones included."""
        return len(self["recipe"])

    def mask(self, state: int) -> NDArray[np.bool_]:
        """The cloth in a state, shape (H, W)."""
        return _unpacked(self["mask"][state])

    def result(self, trial: int) -> NDArray[np.bool_]:
        """The cloth after a trial, shape (H, W)."""
        return _unpacked(self["result"][trial])

    def line(self, state: int) -> FoldLine:
        """The fold line of a state."""
        x0, y0, x1, y1 = self["line"][state].astype(float)
        return FoldLine((x0, y0), (x1, y1))

    def scene(self, state: int) -> Scene:
        """A state as a policy sees it, without a polygon model."""
        mask = self.mask(state)
        garment_kind = self.description["parameters"]["garment_kind"]
        return Scene(garment_kind, (IMAGE[1], IMAGE[0]), mask, contour_of(mask), None, "{}")

    def of_recipes(self, *recipes: str) -> NDArray[np.int64]:
        """Indices of the trials of these recipes that have an outcome, shape (K,)."""
        wanted = [list(RECIPES).index(recipe) for recipe in recipes]
        return np.flatnonzero(np.isin(self["recipe"], wanted) & ~self["diverged"])

    @property
    def error_mm(self) -> NDArray[np.float64]:
        """How far every trial is from the ideal fold, flap and rest [mm], shape (T,); NaN where it diverged."""
        return self["flap_mm"].astype(float) + self["rest_mm"]

    def reward(self, name: str) -> NDArray[np.float64]:
        """Reward ``contour`` or ``particles`` of every trial, shape (T,); NaN where it diverged."""
        state = self["trial_state"]
        if name == "contour":
            return contour_reward(self["chamfer_px"], self["idle_chamfer_px"][state])
        if name == "particles":
            return particle_reward(self.error_mm, self["travel_mm"][state])
        raise ConfigError(f"there is no reward {name!r}; choose contour or particles")


def load_dataset(path: str | Path) -> Dataset:
    """Read a complete data set, a folder or one file (:mod:`polyfold_fgpnp.data.packing`).

    Raises:
        ConfigError: if there is none, it is unfinished, of an unknown schema, or its numbers are not those it was
            finished with.
    """
    path = Path(path)
    if path.is_file():
        description, columns = read_packed(path)
        return Dataset(_of_this_schema(description, path), columns)
    description = _read_description(path)
    if not description.get("complete"):
        raise ConfigError(f"the data set in {path} is not complete; run the same `polyfold collect` again to finish it")
    if _hash(path) != description["hash"]:
        raise _changed(path)
    shards, offset = [], 0
    for shard in _shards(path):
        shard["trial_state"] = shard["trial_state"] + offset
        offset += len(shard["mask"])
        shards.append(shard)
    return Dataset(description, {name: np.concatenate([shard[name] for shard in shards]) for name in shards[0]})


def describe_dataset(path: str | Path) -> Description:
    """What a data set says of itself, its counts among it, without reading what it holds.

    Args:
        path: a folder or one file.

    Raises:
        ConfigError: if there is none, or it is of an unknown schema.
    """
    path = Path(path)
    return _of_this_schema(read_packed_description(path), path) if path.is_file() else _read_description(path)


def pack_dataset(path: str | Path, file: str | Path) -> int:
    """Write a complete data set into one file and return its size in bytes.

    Raises:
        ConfigError: as :func:`load_dataset`.
    """
    data = load_dataset(path)
    write_packed(file, data.description, data.columns, row=IMAGE[1] // 8)
    return Path(file).stat().st_size


def _read_description(path: Path) -> Description:
    file = path / "dataset.json"
    if not file.exists():
        raise ConfigError(f"there is no data set in {path}; make one with: polyfold collect --out {path}")
    try:
        description = json.loads(file.read_text("utf-8"))
    except (ValueError, RecursionError) as error:
        raise _damaged(file, str(error)) from error
    if not isinstance(description, dict) or "parameters" not in description:
        raise _damaged(file, "it describes no data set")
    return _of_this_schema(description, file)


def _of_this_schema(description: Description, file: Path) -> Description:
    if description.get("schema_version") == 1:
        return _from_schema_1(description)
    if description.get("schema_version") != SCHEMA:
        raise ConfigError(
            f"{file} has schema version {description.get('schema_version')}, this polyfold reads {SCHEMA}; collect anew"
        )
    return description


def _damaged(file: Path, why: str) -> ConfigError:
    return ConfigError(
        f"{file} is damaged ({why}); remove it and collect with the same options again, which keeps the shards"
    )


def _from_schema_1(description: Description) -> Description:
    """A description of the time when the simulator and the segmenter could not be chosen."""
    parameters = {**description["parameters"]}
    parameters["garment_kind"] = parameters.pop("kind")
    parameters["simulator"] = {"name": "xpbd", "params": parameters["simulator"]}
    parameters["segmenter"] = {"name": "colour", "params": {}}
    return {**description, "schema_version": SCHEMA, "parameters": parameters}


def _changed(path: Path) -> ConfigError:
    return ConfigError(
        f"shards in {path} have changed since it was finished; collect with the same options again, "
        "which makes damaged ones anew, or into another folder"
    )


def _shards(path: Path) -> Iterator[dict[str, NDArray[Any]]]:
    for file in sorted((path / "shards").glob("*.npz")):
        try:
            yield _shard(file)
        except ConfigError as error:
            raise ConfigError(f"{error}; collect with the same options again, which makes it anew") from error


def _shard(file: Path) -> dict[str, NDArray[Any]]:
    try:
        with np.load(file, allow_pickle=False) as shard:
            return dict(shard)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise ConfigError(f"{file} is damaged ({error})") from error


def _hash(path: Path) -> str:
    whole = hashlib.sha256()
    for file in sorted((path / "shards").glob("*.npz")):
        whole.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    return whole.hexdigest()


def _unpacked(bits: NDArray[np.uint8]) -> NDArray[np.bool_]:
    height, width = IMAGE
    return np.unpackbits(bits, count=height * width).reshape(IMAGE).astype(bool)
