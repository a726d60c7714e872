"""Compiling with numba: machine code kept on disk where there is a place for it, and what its faults become."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


def kept(function: Callable[..., Any]) -> Any:
    """Compile a function and keep its machine code for other processes.

    Without a place to keep it (an install that may not be written to, and no home either) it is compiled in each
    process, and where what was kept is damaged (numba 0.68 reads an emptied file as a fault) it is compiled anew; both
    with a warning.
    """
    from numba import njit  # half a second, which those who only look at the simulator's settings need not wait for

    try:
        dispatcher = njit(cache=True, error_model="numpy")(function)
    except RuntimeError as error:
        if "no locator" not in str(error):
            raise
        warnings.warn(
            "there is no place where compiled code can be kept, so each start takes half a minute longer; "
            "set NUMBA_CACHE_DIR to a folder that can be written to",
            stacklevel=2,
        )
        return njit(error_model="numpy")(function)
    _forgive(dispatcher._cache)
    return dispatcher


def _forgive(cache: Any) -> None:
    """Have a cache of numba's lose what is damaged, and do without what can't be written."""
    load, save = cache.load_overload, cache.save_overload

    def load_overload(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception as error:  # unpickling raises whatever the damaged bytes make of it
            warnings.warn(f"compiled code in {cache.cache_path} is damaged ({error}); compiling it anew", stacklevel=2)
            with _warning_if_unwritable(cache):
                cache.flush()
            return None

    def save_overload(signature: Any, data: Any) -> None:
        with _warning_if_unwritable(cache):
            save(signature, data)

    cache.load_overload, cache.save_overload = load_overload, save_overload


@contextmanager
def _warning_if_unwritable(cache: Any) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        warnings.warn(
            f"compiled code could not be kept in {cache.cache_path} ({error}); set NUMBA_CACHE_DIR to another folder",
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
