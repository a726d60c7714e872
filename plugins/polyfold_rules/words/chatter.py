"""Tokens that people add without meaning a fold, and unknown verbs that can only mean moving something."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from polyfold_rules.words.phrases import starts_noun_phrase
from polyfold_rules.words.tokens import Token

_SEPARATES = ("stop", "join", "seq", "but")
_IDLE = ("unknown", "pronoun", "loose")
"""What an idle remark may consist of; a denial or a measure is never idle."""


def plain_tokens(tokens: Sequence[Token]) -> tuple[list[Token], list[str]]:
    """The tokens without idle remarks, unknown verbs read as *move*; and the words passed over.

    A remark is idle if stops or commas set it apart, it holds unknown words only, and a fold is told elsewhere.
    """
    tokens = [_moved(tokens, at) for at in range(len(tokens))]
    kept: list[Token] = []
    passed: list[str] = []
    tells = any(token.category in ("noun", "side", "frac", "goal", "manner") for token in tokens)
    for segment in _segments(tokens):
        unknown = [token.text for token in segment if token.category == "unknown"]
        if tells and unknown and all(token.category in (*_IDLE, *_SEPARATES) for token in segment):
            passed += unknown
            kept += [token for token in segment if token.category == "stop"]
        else:
            kept += segment
    return kept, passed


def _segments(tokens: Sequence[Token]) -> list[list[Token]]:
    """Runs of tokens up to and with the stop or comma that ends them."""
    runs: list[list[Token]] = [[]]
    for token in tokens:
        runs[-1].append(token)
        if token.category == "stop" or token.is_("join", "comma", "colon"):
            runs.append([])
    return runs


def _moved(tokens: Sequence[Token], at: int) -> Token:
    """An unknown verb before a part with a place (*chuck the corner over there*) or a participle before a place."""
    token = tokens[at]
    if token.category != "unknown" or token.form == "adjective":
        return token
    begins = at == 0 or tokens[at - 1].category in _SEPARATES
    if begins and starts_noun_phrase(tokens, at + 1) and _placed(tokens, at + 1):
        return replace(token, category="verb", value="move")
    if token.text.endswith("ed") and at + 1 < len(tokens) and tokens[at + 1].category in ("prep", "dir"):
        return replace(token, category="verb", value="move", form="past")
    return token


def _placed(tokens: Sequence[Token], at: int) -> bool:
    """Whether the clause names a part and then says where it goes."""
    named = False
    for token in tokens[at:]:
        if token.category in ("stop", "seq"):
            return False
        if token.category in ("noun", "side"):
            named = True
        if named and (token.is_("prep", "to", "over") or token.category == "dir"):
            return True
    return False
