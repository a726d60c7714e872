"""What a pattern of words makes of a wish: readers that several tables of patterns share."""

from __future__ import annotations

import re
from collections.abc import Callable

from polyfold_rules.wishes.wish import Wish

Reader = Callable[[Wish, re.Match[str]], None]
"""Adds to the wish what the words found say."""


def nothing(wish: Wish, match: re.Match[str]) -> None:
    """Words that make no difference to the end."""


def tidy(wish: Wish, match: re.Match[str]) -> None:
    """Neat, however folded."""
    wish.tidy = True


def stacked(wish: Wish, match: re.Match[str]) -> None:
    """To lie in a pile or to stand in a row."""
    wish.purposes.append("pile")


def hides(wish: Wish, match: re.Match[str]) -> None:
    """The sleeve of the group ``side``, or both, out of sight."""
    side = match.groupdict().get("side")
    wish.hidden |= {side} if side else {"left", "right"}


def one_sleeve(wish: Wish, match: re.Match[str]) -> None:
    """Either sleeve folded in."""
    wish.looks.append("onesleeve")


def shortened(wish: Wish, match: re.Match[str]) -> None:
    """The hem or the leg ends brought up."""
    wish.looks.append("shorts")
