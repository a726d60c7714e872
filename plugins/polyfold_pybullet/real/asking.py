"""Before anything moves, a person agrees; and whatever ends the program ends what moves."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

from polyfold.errors import RobotError

Asks = Literal["each", "start", "never"]

ENDINGS = ("SIGTERM", "SIGHUP")
"""Signals that would end the program without a word: a closed terminal, a lost connection, a shutdown."""


def agreed(what: str) -> None:
    """Have a person at the terminal agree to what is about to be done, by ``y``.

    What was typed before the question counts for nothing.

    Raises:
        RobotError: if they don't agree, or nobody is there to.
    """
    terminal = _terminal(
        "to agree before arms move; run this at one, or, where the cell is fenced off, with confirm = never"
    )
    print(f"{what}\n  y: do it (Ctrl-C stops the arms); q: stop here > ", end="", file=sys.stderr, flush=True)
    while (said := terminal.readline().strip().casefold()) not in ("y", "yes"):
        if said in ("q", "n", "no", ""):
            raise RobotError("not agreed to, so nothing moves; run it again to go on from where the cloth lies")
        print("  y or q > ", end="", file=sys.stderr, flush=True)


def wants_more(what: str) -> bool:
    """Whether a person at the terminal, who does what is said, presses Enter for one more; ``q`` is enough.

    Raises:
        RobotError: if nobody is there.
    """
    terminal = _terminal("to press Enter for each view; run this at one")
    print(f"{what}\n  Enter: take it; q: enough > ", end="", file=sys.stderr, flush=True)
    said = terminal.readline()
    return said != "" and said.strip().casefold() not in ("q", "quit", "n", "no")


def _terminal(what_for: str) -> Any:
    """The terminal, with nothing typed ahead. Raises RobotError if nobody is at one."""
    terminal = sys.stdin
    if terminal is None or terminal.closed or not terminal.isatty():
        raise RobotError(f"nobody is at a terminal {what_for}")
    _forget_what_was_typed(terminal)
    return terminal


def _forget_what_was_typed(terminal: Any) -> None:
    try:
        import termios

        termios.tcflush(terminal.fileno(), termios.TCIFLUSH)
    except (ImportError, OSError, ValueError):  # no such terminal, on this system or in a test
        return


@contextmanager
def endings_raise() -> Iterator[None]:
    """Signals that end the program raise SystemExit meanwhile, as Ctrl-C raises KeyboardInterrupt."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, _: Any) -> None:
        raise SystemExit(128 + number)

    numbers = [getattr(signal, name) for name in ENDINGS if hasattr(signal, name)]
    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
