"""The anchored form of a subgoal: *fold <part> <direction, optional> to <part> <symmetry axis, optional>*."""

from __future__ import annotations

import re

from polyfold.errors import PlanError
from polyfold.polygon import Template

_FORM = re.compile(
    r"fold (?P<part>.+?)"
    r"(?: (?:inwards?|outwards?|upwards?|downwards?|leftwards?|rightwards?|up|down|over|in|across|diagonally))*"
    r" (?:on)?to (?P<target>.+?)(?: (?:along|about|across) (?P<axis>.+?))?\.?",
    re.IGNORECASE,
)
_SIDES = (
    r"(?:(?:left|right|top|bottom|upper|lower|long|short|longer|shorter|other|opposite|remaining|inner|outer|middle|"
    r"acute) )*"
)
_GENERAL = re.compile(
    rf"{_SIDES}(?:edges?|sides?|hal(?:f|ves)|corners?|parts?|portion|strip|flap|fold|crease|triangle)"
    rf"|{_SIDES}(?:(?:one|two|three) )?(?:thirds?|quarters?|fifths?|sixths?|eighths?)|\d+(?:\.\d+)? cm"
    rf"|(?:(?:vertical|horizontal) )?(?:centre|center|middle|midpoint)(?: (?:line|point|axis))?|gap|rest|cloth|garment"
)
"""Parts that every garment has, whatever its template names."""


def check_subgoal(text: str, template: Template) -> None:
    """Check form and part names.

    Raises:
        PlanError: saying what is wrong, in words for the model that wrote it.
    """
    found = _FORM.fullmatch(" ".join(text.split()))
    if found is None:
        raise PlanError(
            f'the subgoal "{text}" does not have the form "fold the <part> <direction> to the <part> <along axis>"; '
            "rewrite it"
        )
    for role in ("part", "target"):
        if not _exists(found[role], template):
            known = ", ".join([*template.parts, *(name.replace("_", " ") for name in template.names)])
            raise PlanError(
                f'the subgoal "{text}" names the part "{found[role]}", which a {template.kind} does not have; '
                f"use one of: {known}, or an edge, half, third or corner, the centre or the middle line"
            )


def _exists(phrase: str, template: Template) -> bool:
    """Whether every piece of the phrase is a part of the template or one that every garment has."""
    known = {_plain(name) for name in (*template.parts, *template.names)} | {_plain(template.kind)}
    pieces = [_plain(piece) for piece in re.split(r"\band\b|,|\bof\b", phrase.lower())]
    return all(piece in known or _GENERAL.fullmatch(piece) for piece in pieces if piece)


def _plain(words: str) -> str:
    words = re.sub(r"[_-]", " ", words.lower())
    return " ".join(word for word in words.split() if word not in ("the", "a", "an", "one", "its", "both", "edge's"))
