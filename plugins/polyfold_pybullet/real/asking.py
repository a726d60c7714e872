"""Before anything moves, a person agrees."""

from __future__ import annotations

import sys
from typing import Literal

from polyfold.errors import RobotError

Asks = Literal["each", "start", "never"]


def ask(what: str) -> bool:
    """Whether a person at the terminal says yes to what is about to be done; Enter is yes, ``s`` is to skip it.

    Raises:
        RobotError: if they say that it is enough, or nobody is there to say anything.
    """
    print(f"{what}\n  Enter: do it; s: skip it; q: stop here > ", end="", file=sys.stderr, flush=True)
    try:
        said = input().strip().casefold()
    except (EOFError, OSError) as error:
        raise RobotError(
            "nobody is there to agree before arms move; run this at a terminal, or, where the cell is fenced off, "
            "with confirm = never"
        ) from error
    if said in ("", "y", "yes"):
        return True
    if said in ("s", "skip"):
        return False
    raise RobotError("stopped by hand before the arms moved; run it again to go on from where the cloth lies")
