"""Compiling with numba: machine code kept on disk where there is a place for it, and what its faults become."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from threading import Event, Thread
from typing import Any

LONG = 2.0
"""Seconds after which it is said that something is being compiled; reading what was kept takes less."""


def kept(function: Callable[..., Any]) -> Any:
    """Compile a function and keep its machine code for other processes.

    Without a place to keep it (an install that may not be written to, and no home either) it is compiled in each
    process, and where what was kept is damaged (numba 0.68 reads an emptied file as a fault) it is compiled anew; both
    with a warning.
    """
    # Half a second, which those who only look at the simulator's settings need not wait for.
    from numba import config, njit

    if getattr(config, "DISABLE_JIT", 0):  # for debuggers and coverage
        _mention_plain_python()
        return function
    try:
        dispatcher = njit(cache=True, error_model="numpy")(function)
    except RuntimeError as error:
        if "no locator" not in str(error):
            raise
        _mention_no_place()
        return _announced(njit(error_model="numpy")(function))
    _forgive(dispatcher._cache)  # pyright: ignore[reportAttributeAccessIssue]
    return _announced(dispatcher)


def _announced(dispatcher: Any) -> Any:
    """Have it said when compiling takes long, so that nobody takes the first fold after an install for a fault."""
    compiled = dispatcher.compile

    def compile(signature: Any) -> Any:
        with _patience():
            return compiled(signature)

    dispatcher.compile = compile
    return dispatcher


@contextmanager
def _patience() -> Iterator[None]:
    done = Event()
    thread = Thread(target=_tell, args=(done,), daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _tell(done: Event) -> None:
    """Say what takes so long to whoever watches, at a terminal or in a notebook, with the seconds until it is done."""
    watched = sys.stderr.isatty() or "ipykernel" in sys.modules
    begun = time.monotonic()
    if done.wait(LONG) or not watched:
        return
    what = "compiling the cloth's kernels for this processor, once after an install"
    while not done.wait(1.0):
        print(f"\rpolyfold: {what}: {time.monotonic() - begun:.0f} s", end="", file=sys.stderr, flush=True)
    print(f"\rpolyfold: {what}: {time.monotonic() - begun:.0f} s", file=sys.stderr, flush=True)


@cache
def _mention_plain_python() -> None:
    warnings.warn(
        "NUMBA_DISABLE_JIT is set: the cloth folds in plain Python, hundreds of times slower; unset it",
        stacklevel=3,
    )


@cache
def _mention_no_place() -> None:
    warnings.warn(
        "there is no place where compiled code can be kept, so each start takes half a minute longer; "
        "set NUMBA_CACHE_DIR to a folder that can be written to",
        stacklevel=3,
    )


def _forgive(kept_code: Any) -> None:
    """Have a cache of numba's lose what is damaged, and do without what can't be written."""
    load, save = kept_code.load_overload, kept_code.save_overload

    def load_overload(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except OSError:  # not to be read, which is not damaged: others may read it
            return None
        except Exception as error:  # unpickling raises whatever the damaged bytes make of it
            where = kept_code.cache_path
            warnings.warn(f"compiled code in {where} is damaged ({error}); compiling it anew", stacklevel=2)
            with _warning_if_unwritable(kept_code):
                kept_code.flush()
            return None

    def save_overload(signature: Any, data: Any) -> None:
        with _warning_if_unwritable(kept_code):
            save(signature, data)

    kept_code.load_overload, kept_code.save_overload = load_overload, save_overload


@contextmanager
def _warning_if_unwritable(kept_code: Any) -> Iterator[None]:
    try:
        yield
    except Exception as error:  # of the disk, or of a damaged index that could not be emptied
        warnings.warn(
            f"compiled code could not be kept in {kept_code.cache_path} ({error}); "
            "set NUMBA_CACHE_DIR to another folder",
            stacklevel=3,
        )


@contextmanager
def interruptible() -> Iterator[None]:
    """Let an interrupt that comes within compiled code end in KeyboardInterrupt.

    Python calls it a SystemError if a signal is handled between a kernel's end and its return (numba 0.68, as when
    JupyterLab interrupts a cell).
    """
    try:
        yield
    except SystemError as error:
        if isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from None
        raise
