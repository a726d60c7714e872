"""Compiled code that can't be kept, or was damaged where it is kept, costs time and nothing else."""

import io
import warnings
from importlib import import_module

import pytest
from polyfold_xpbd.compiling import _mention_no_place, _mention_plain_python, interruptible, kept


@pytest.fixture
def double(tmp_path, monkeypatch):
    (tmp_path / "doubling.py").write_text("def double(x):\n    return 2 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(__import__("sys").modules, "doubling", raising=False)
    return import_module("doubling").double


def quietly(function, *arguments):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return function(*arguments)


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("content", [b"", b"\x80\x05 no pickle"])
def test_damaged_code_is_compiled_anew_and_said_once(double, tmp_path, ending, content):
    assert quietly(kept(double), 2) == 4
    (damaged,) = tmp_path.rglob(f"*.{ending}")
    damaged.write_bytes(content)
    with pytest.warns(UserWarning, match="is damaged .* compiling it anew"):
        assert kept(double)(2) == 4
    again = kept(double)
    assert quietly(again, 2) == 4
    assert sum(again.stats.cache_hits.values()) == 1


def test_without_a_place_to_keep_it_code_is_compiled_with_a_warning(double, monkeypatch):
    monkeypatch.setattr("numba.core.caching.CacheImpl._locator_classes", [])
    _mention_no_place.cache_clear()
    with pytest.warns(UserWarning, match=r"no place where compiled code can be kept.* set NUMBA_CACHE_DIR"):
        compiled = kept(double)
    assert quietly(compiled, 2) == 4
    assert quietly(kept(double), 2) == 4, "it is said once"


@pytest.mark.parametrize(("long", "terminal"), [(0.0, True), (60.0, True), (0.0, False)])
def test_compiling_that_takes_long_is_said_at_a_terminal(double, monkeypatch, long, terminal):
    told = io.StringIO()
    told.isatty = lambda: terminal
    monkeypatch.setattr("sys.stderr", told)
    monkeypatch.setattr("polyfold_xpbd.compiling.LONG", long)
    compiled = kept(double)
    assert compiled(2) == 4
    said = told.getvalue()
    assert ("compiling the cloth's kernels for this processor, once after an install" in said) == (
        long == 0.0 and terminal
    )
    assert compiled(3) == 6
    assert told.getvalue() == said, "and nothing once it is there"


def test_where_nothing_is_compiled_functions_stay_as_they_are(double, monkeypatch):
    monkeypatch.setattr("numba.config.DISABLE_JIT", 1)
    _mention_plain_python.cache_clear()
    with pytest.warns(UserWarning, match="NUMBA_DISABLE_JIT is set: .* hundreds of times slower"):
        assert kept(double) is double
    assert quietly(kept, double) is double, "it is said once"


def test_an_index_that_a_full_disk_emptied_does_not_end_a_run(double, tmp_path, monkeypatch):
    def full(cache, path):
        raise OSError(28, "No space left on device")

    assert kept(double)(2) == 4
    (index,) = tmp_path.rglob("*.nbi")
    index.write_bytes(b"")
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._open_for_write", full)
    with pytest.warns(UserWarning, match="is damaged") as told:
        assert kept(double)(2) == 4
    assert sum("could not be kept" in str(warning.message) for warning in told) == 2


def test_a_full_disk_does_not_stop_what_was_compiled(double, monkeypatch):
    def full(cache, key, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", full)
    with pytest.warns(UserWarning, match="could not be kept in .*No space left on device"):
        assert kept(double)(2) == 4


def test_an_interrupt_within_compiled_code_is_one():
    with pytest.raises(KeyboardInterrupt), interruptible():
        raise SystemError("CPUDispatcher(...) returned a result with an exception set") from KeyboardInterrupt()
    with pytest.raises(SystemError, match="otherwise"), interruptible():
        raise SystemError("otherwise")
