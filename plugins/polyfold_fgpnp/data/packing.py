"""A data set as one small file, to publish: ``polyfold collect --out DIR --pack FILE``.

It is a zip archive of ``description.json`` and one array ``NAME.npy`` a column, compressed with LZMA. Each row of a
mask is stored as what differs from the row above, and of results only those that are not the next state's mask, which
on the random course most are.
"""

from __future__ import annotations

import hashlib
import io
import json
import lzma
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError

Columns = dict[str, NDArray[Any]]

_DESCRIPTION = "description.json"
_DATE = (1980, 1, 1, 0, 0, 0)
"""Of every member, so that the same data make the same file."""
_DAMAGES = (OSError, ValueError, KeyError, TypeError, IndexError, EOFError, zipfile.BadZipFile, lzma.LZMAError)
"""What reading a file that is damaged, or something else, raises."""


def write_packed(
    path: str | Path, description: Mapping[str, Any], columns: Mapping[str, NDArray[Any]], row: int
) -> None:
    """Write a data set into one file, whole or not at all.

    Args:
        path: the file.
        description: what ``dataset.json`` says of it.
        columns: its columns, of the shapes that :mod:`polyfold_fgpnp.data.dataset` names.
        row: bytes of a row of a mask.
    """
    path = Path(path)
    stored = _without_repeats({**columns})
    for name in ("mask", "result"):
        stored[name] = _differences(stored[name], row)
    content = {**description, "columns": _digest(columns), "row": row}
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr(_member(_DESCRIPTION), json.dumps(content, indent=2))
        for name, values in stored.items():
            stream = io.BytesIO()
            np.save(stream, values, allow_pickle=False)
            archive.writestr(_member(f"{name}.npy"), stream.getvalue())
    part.replace(path)


def read_packed(path: str | Path) -> tuple[dict[str, Any], Columns]:
    """The description and the columns of a data set in one file.

    Raises:
        ConfigError: if it is no such file, or its numbers are not those that were written.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            description = json.loads(archive.read(_DESCRIPTION))
            names = [name for name in archive.namelist() if name.endswith(".npy")]
            stored = {name.removesuffix(".npy"): _array(archive.read(name)) for name in names}
        digest, row = description.pop("columns"), int(description.pop("row"))
        for name in ("mask", "result"):
            stored[name] = _sums(stored[name], row)
        columns = _with_repeats(stored)
        if _digest(columns) != digest:
            raise ValueError("its numbers are not those that were written")
    except _DAMAGES as error:
        raise _damaged(path, error) from error
    return description, columns


def read_packed_description(path: str | Path) -> dict[str, Any]:
    """The description alone. Raises ConfigError if it is no such file."""
    try:
        with zipfile.ZipFile(path) as archive:
            return dict(json.loads(archive.read(_DESCRIPTION)))
    except _DAMAGES as error:
        raise _damaged(path, error) from error


def _damaged(path: str | Path, error: Exception) -> ConfigError:
    return ConfigError(
        f"{path} is no data set of `polyfold collect --pack`, or damaged ({error}); fetch it again, or collect anew"
    )


def _member(name: str) -> zipfile.ZipInfo:
    member = zipfile.ZipInfo(name, _DATE)
    member.compress_type = zipfile.ZIP_LZMA
    return member


def _array(content: bytes) -> NDArray[Any]:
    return np.load(io.BytesIO(content), allow_pickle=False)


def _differences(bits: NDArray[np.uint8], row: int) -> NDArray[np.uint8]:
    """Packed masks, shape (N, B), each row against the one above it."""
    rows = bits.reshape(len(bits), -1, row)
    changed = rows.copy()
    changed[:, 1:] ^= rows[:, :-1]
    return changed.reshape(bits.shape)


def _sums(changed: NDArray[np.uint8], row: int) -> NDArray[np.uint8]:
    """What :func:`_differences` was made of."""
    return np.bitwise_xor.accumulate(changed.reshape(len(changed), -1, row), axis=1).reshape(changed.shape)


def _without_repeats(columns: Columns) -> Columns:
    """Results only where they are not the mask of the next state; ``repeated``, shape (T,), says which those are."""
    following = np.minimum(columns["trial_state"] + 1, len(columns["mask"]) - 1)
    repeated = (columns["result"] == columns["mask"][following]).all(1)
    return {**columns, "result": columns["result"][~repeated], "repeated": repeated}


def _with_repeats(stored: Columns) -> Columns:
    repeated = stored.pop("repeated")
    following = np.minimum(stored["trial_state"] + 1, len(stored["mask"]) - 1)
    results = stored["mask"][following]
    results[~repeated] = stored["result"]
    return {**stored, "result": results}


def _digest(columns: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 of all columns: names, types, shapes and values."""
    whole = hashlib.sha256()
    for name, values in sorted(columns.items()):
        whole.update(json.dumps([name, values.dtype.str, list(values.shape)]).encode())
        whole.update(np.ascontiguousarray(values).tobytes())
    return whole.hexdigest()
