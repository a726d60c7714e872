"""Clauses: each frame holds what one clause says about a fold, in the order of the words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from polyfold_rules.words.phrases import NounPhrase

WHOLES = ("triangle", "result", "rest")
"""Nouns that stand for the garment as folded so far."""


@dataclass
class Frame:
    """What one clause says; every list is in the order of the words."""

    verbs: list[str] = field(default_factory=list)
    moving: list[NounPhrase] = field(default_factory=list)
    targets: list[NounPhrase] = field(default_factory=list)
    axes: list[NounPhrase] = field(default_factory=list)
    restated: list[NounPhrase] = field(default_factory=list)
    directions: list[str] = field(default_factory=list)
    manners: list[str] = field(default_factory=list)
    fractions: list[str] = field(default_factory=list)
    goals: list[str] = field(default_factory=list)
    excluded: list[NounPhrase] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    times: int = 1
    again: bool = False
    same: bool = False
    too: bool = False
    only: bool = False
    negated: bool = False
    from_source: bool = False
    elliptical: bool = False
    aside: bool = False
    context: NounPhrase | None = None
    leads: NounPhrase | None = None
    phrasal: bool = False
    announces: bool = False
    grasped: bool = False
    shared: bool = False

    @property
    def empty(self) -> bool:
        """Whether nothing but fillers was said."""
        return not (
            self.verbs or self.moving or self.targets or self.axes or self.directions or self.manners or self.fractions
            or self.goals or self.excluded or self.refused or self.unknown or self.same or self.negated or self.again
        )  # fmt: skip

    @property
    def placed(self) -> bool:
        """Whether the clause already says where something goes or how."""
        return bool(self.targets or self.directions or self.manners or self.axes)

    @property
    def specific(self) -> bool:
        """Whether a part, not the whole garment, moves."""
        return any(phrase.names_part and phrase.noun not in WHOLES for phrase in self.moving)


@dataclass
class Request:
    """The whole instruction: its frames in order of execution, the garments it names, a stated number of steps."""

    frames: list[Frame]
    garments: list[str]
    steps: int | None = None
    several: bool = False
    passed: tuple[str, ...] = ()


def in_order(done: Sequence[tuple[str, Frame]]) -> list[Frame]:
    """Clauses marked ``earlier`` come before everything of their sentence; ``later`` ones after the next."""
    ordered: list[Frame] = []
    waiting: list[Frame] = []
    start = 0
    for order, frame in done:
        if order == "sentence":
            start = len(ordered)
            ordered.append(frame)
        elif order == "earlier":
            ordered.insert(start, frame)
            start += 1
        elif order == "later":
            waiting.append(frame)
            continue
        else:
            ordered.append(frame)
        ordered += waiting
        waiting = []
    return ordered + waiting
