"""Numbers on the command line: what is wrong with one is said before anything is done."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

from polyfold.errors._hints import whole_number_problem


def whole_number(least: int = 0) -> Callable[[str], int]:
    """The ``type`` of an option that takes whole numbers from ``least`` on."""

    def parse(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if problem := whole_number_problem(number, least, text):
            raise argparse.ArgumentTypeError(problem)
        return number

    return parse


def metres(text: str) -> float:
    """The ``type`` of an option that takes a length [m]."""
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not (math.isfinite(length) and length > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is no length; give metres above zero, for example 0.02")
    return length


def share(text: str) -> float:
    """The ``type`` of an option that takes a share of a whole."""
    try:
        part = float(text)
    except ValueError:
        part = math.nan
    if not 0 <= part <= 1:
        raise argparse.ArgumentTypeError(f"{text!r} is no share; give a number from 0 to 1, for example 0.5")
    return part


TYPES = {"seed": whole_number(0), "count": whole_number(1), "metres": metres, "share": share}
"""By the name that an option of any verb, a plugin's too, gives as its ``type``."""
