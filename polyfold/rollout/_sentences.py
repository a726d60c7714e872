"""The sentence that a person gives, as text that every part, file and provider can carry."""

from __future__ import annotations

import unicodedata
import warnings

from polyfold.errors import ConfigError

_TURNS = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Marks that change the direction of writing: a sentence may then show as other words than those that are read."""


def plain(instruction: str) -> str:
    """The sentence without control characters and marks of direction, of which is warned.

    Raises:
        ConfigError: if it is no text, or holds half a surrogate pair, as a terminal leaves of bytes in another
            encoding.
    """
    if not isinstance(instruction, str):
        raise ConfigError(f"{instruction!r} is no sentence; say in words what to fold")
    if any("\ud800" <= character <= "\udfff" for character in instruction):
        shown = instruction.encode("utf-8", "backslashreplace").decode()
        raise ConfigError(
            f"the sentence {shown!r} holds bytes that are no UTF-8; type it again, or set the terminal to UTF-8"
        )
    cleaned = "".join(" " if _is_control(character) else character for character in instruction)
    cleaned = "".join(character for character in cleaned if character not in _TURNS)
    if cleaned != instruction:
        count = sum(_is_control(character) or character in _TURNS for character in instruction)
        warnings.warn(
            f"{count} invisible character{'s' * (count > 1)} (control, direction of writing) of the sentence "
            f"{'are' if count > 1 else 'is'} left out; it is read as {cleaned!r}",
            stacklevel=3,
        )
    return cleaned


def _is_control(character: str) -> bool:
    return unicodedata.category(character) == "Cc" and character not in "\n\r\t"
