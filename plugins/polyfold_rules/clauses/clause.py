"""A clause with its phrases resolved to parts of the garment: what the choice of a fold is made from."""

from __future__ import annotations

from dataclasses import dataclass, replace

from polyfold_rules.frames.frame import Frame
from polyfold_rules.shapes.folds import OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.parts import Garment, Part, resolve
from polyfold_rules.words.phrases import NounPhrase

TOWARDS = {"up": "bottom", "down": "top", "right": "left", "left": "right"}
"""Direction -> the edge that moves that way."""

MIDDLE = ("centre", "midline", "gap")


@dataclass(frozen=True)
class Clause:
    """A frame with its phrases resolved."""

    frame: Frame
    targets: tuple[Part, ...]
    axes: tuple[Part, ...]

    def has(self, *manners: str) -> bool:
        """Whether one of these manners was said."""
        return any(manner in self.frame.manners for manner in manners)

    def toward(self, *places: str) -> bool:
        """Whether a target is one of these places."""
        return any(part.what in places for part in self.targets)


def parts_of(phrase: NounPhrase, garment: Garment, role: str, context: NounPhrase | None) -> list[Part]:
    """The parts a phrase names, checked against the garment."""
    return resolve(phrase, garment, role, context)


def ahead_of(garment: Garment, more: list[Fold]) -> Garment:
    """The garment as it will be after further folds; notes are shared."""
    return replace(garment, folds=[*garment.folds, *more])


def moving_edge(clause: Clause, garment: Garment) -> str | None:
    """Which edge moves in a half fold of the whole garment, if the words tell."""
    for direction in clause.frame.directions:
        if direction in TOWARDS:
            return TOWARDS[direction]
    spans = {part.which for part in clause.axes if part.what == "edge"}
    if clause.has("vertical") or any(part.what == "crotch" for part in clause.axes) or spans == {"top", "bottom"}:
        return "left"
    if clause.has("horizontal") or spans == {"left", "right"}:
        return "bottom"
    goals = {part.which for part in clause.targets if part.what == "edge"} & set(OPPOSITE_EDGE) - {"long", "short"}
    if len(goals) == 1:
        return OPPOSITE_EDGE[goals.pop()]
    long_way = garment.kind == "rectangle"
    if clause.has("lengthwise"):
        return "long" if long_way else "left"
    if clause.has("crosswise"):
        return "short" if long_way else "bottom"
    return None
