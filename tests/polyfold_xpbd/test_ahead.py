"""Kernels compiled ahead of time are those of the sources, and where they can't be used numba compiles."""

import json
import shutil

import numpy as np
import pytest
from polyfold_xpbd.ahead import calling
from polyfold_xpbd.ahead.calling import Ahead, digest, type_of
from polyfold_xpbd.kernels.vectors import vertex_normals

CORNERS = np.array([[0, 1, 2]], np.uint32)


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A copy of what is shipped, which a test may spoil."""
    for file in calling.FOLDER.glob("kernels.*"):
        shutil.copy(file, tmp_path)
    monkeypatch.setattr(calling, "FOLDER", tmp_path)
    monkeypatch.setattr(calling, "INDEX", tmp_path / "kernels.json")
    caches = calling._variants, calling._made, calling._engine
    for cache in caches:
        cache.cache_clear()
    yield tmp_path
    for cache in caches:
        cache.cache_clear()


@pytest.fixture
def normals():
    """The normals of one triangle, and by whom they were computed."""
    asked = []

    def numba(*arguments):
        asked.append("numba")
        return vertex_normals(*arguments)

    kernel = Ahead(numba, "average_normals")

    def compute(corners=CORNERS):
        x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], np.float32)
        found = np.zeros((3, 3), np.float32)
        assert kernel(x, corners, np.ones(corners.shape, np.float32), found) is None
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, rtol=1e-6)
        assert (found[:, 2] > 0.0).all()
        return asked.pop() if asked else "ahead"

    return compute


def test_what_is_shipped_was_made_from_these_sources():
    index = json.loads(calling.INDEX.read_text())
    assert index["digest"] == digest(), "a kernel has changed: run python -m polyfold_xpbd.ahead.making"


def test_it_is_used_where_it_was_made_for_such_arguments(normals):
    assert normals() == "ahead"
    assert normals(CORNERS.astype(np.int64)) == "numba"
    assert normals(np.asfortranarray(np.repeat(CORNERS, 2, axis=0))) == "numba"


@pytest.mark.parametrize("fault", ["machine", "system", "none", "older", "unreadable", "a symbol is missing"])
def test_where_it_can_t_be_used_numba_compiles(place, normals, monkeypatch, fault):
    if fault == "machine":
        monkeypatch.setattr("platform.machine", lambda: "riscv64")
    elif fault == "system":
        monkeypatch.setattr("platform.system", lambda: "Windows")
    elif fault == "none":
        (place / "kernels.json").unlink()
    elif fault == "older":
        index = json.loads((place / "kernels.json").read_text())
        (place / "kernels.json").write_text(json.dumps({**index, "digest": "0" * 64}))
    elif fault == "unreadable":
        (place / "kernels.bc").write_bytes(b"BC of a newer LLVM")
    else:
        monkeypatch.setattr("llvmlite.binding.address_of_symbol", lambda name: None)
    assert normals() == "numba"


def test_types_are_told_apart_that_would_be_read_otherwise():
    array = np.zeros((2, 3), np.float32)
    fixed = array.copy()
    fixed.flags.writeable = False
    different = [array, array[:, :2], fixed, array.astype(np.float64), array[0], array.astype(np.int32)]
    different += [None, 1, np.float32(1), 1.0, (array,), (array, array), True]
    assert len({type_of(one) for one in different}) == len(different)
