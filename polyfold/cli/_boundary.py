"""Where errors end: what a user can mend becomes one line and an exit status, everything else stays a traceback."""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from polyfold.errors import PolyfoldError, RefusedError, validation_problem
from polyfold.errors._hints import file_problem

FAILED, REFUSED, INTERRUPTED = 1, 3, 130


def answer(error: BaseException) -> tuple[str, int] | None:
    """The line and the exit status for an error that ended a verb; None for one that only a programmer can mend."""
    if isinstance(error, KeyboardInterrupt):
        return "interrupted", INTERRUPTED
    if isinstance(error, RefusedError):
        return f"refused: {error}", REFUSED
    if isinstance(error, PolyfoldError):
        return str(error), FAILED
    if isinstance(error, BrokenPipeError):
        return "", FAILED
    if isinstance(error, OSError):
        return file_problem(error), FAILED
    if isinstance(error, UnicodeError):
        return f"a text holds what is no text ({getattr(error, 'reason', error)}); write it anew", FAILED
    if isinstance(error, ValueError):
        from pydantic import ValidationError

        if isinstance(error, ValidationError):
            return f"{error.title} {validation_problem(error)}", FAILED
    return None


def speak_any_text() -> None:
    """Let standard output show in escapes what its encoding lacks, as standard error does, instead of failing."""
    with suppress(AttributeError, ValueError):
        sys.stdout.reconfigure(errors="backslashreplace")  # pyright: ignore[reportAttributeAccessIssue]


def flush() -> None:
    """Write out what was printed, so that a full disk or a closed pipe is met here and not after the end."""
    try:
        sys.stdout.flush()
    except OSError:
        _forget_output()
        raise


def _forget_output() -> None:
    """Let what can't be written any more go nowhere, or the interpreter would try again when it ends."""
    with suppress(OSError, AttributeError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
