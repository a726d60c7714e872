"""Clauses: each frame holds what one clause says about a fold, in the order in which it is to be done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from polyfold_llms.folding.phrases import NounPhrase, noun_phrase, starts_noun_phrase
from polyfold_llms.folding.tokens import Token

__all__ = ["Frame", "Request", "frames_of"]

MOVES = ("fold", "move", "halve", "tidy", "make", "quarter")


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
    only: bool = False
    negated: bool = False
    from_source: bool = False
    elliptical: bool = False
    leads: NounPhrase | None = None

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
        return any(phrase.names_part for phrase in self.moving)


@dataclass
class Request:
    """The whole instruction: its frames in order of execution, the garments it names, a stated number of steps."""

    frames: list[Frame]
    garments: list[str]
    steps: int | None = None


def frames_of(tokens: Sequence[Token]) -> Request:
    """Assemble the clauses of a tagged instruction."""
    return _Assembler(tokens).run()


class _Assembler:
    """Walks over the tokens once; ``role`` is what the next noun phrase will be."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.tokens = tokens
        self.done: list[tuple[str, Frame]] = []
        self.frame = Frame()
        self.order = "then"
        self.role = "moving"
        self.purpose = False
        self.joined = False
        self.sentence_start = 0
        self.garments: list[str] = []
        self.steps: int | None = None

    def run(self) -> Request:
        at = 0
        while at < len(self.tokens):
            token = self.tokens[at]
            if starts_noun_phrase(self.tokens, at) and not self._ordinal(at):
                phrase, at = noun_phrase(self.tokens, at)
                self._add_phrase(phrase, at)
                self.joined = False
                continue
            getattr(self, f"_on_{token.category}")(token, at)
            self.joined = token.is_("join") or (self.joined and token.category in ("neg", "quant"))
            at += 1
        self._close()
        return Request(self._ordered(), self.garments, self.steps)

    # Order -----------------------------------------------------------------------------------------------------------

    def _close(self, order: str = "then") -> None:
        if not self.frame.empty:
            self.done.append((self.order, self.frame))
            self.order = order
        elif order != "then":
            self.order = order
        self.frame = Frame()
        self.role, self.purpose = "moving", False

    def _ordered(self) -> list[Frame]:
        """Clauses marked ``earlier`` come before everything of their sentence; ``later`` ones after the next."""
        ordered: list[Frame] = []
        waiting: list[Frame] = []
        start = 0
        for order, frame in self.done:
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

    def _on_stop(self, token: Token, at: int) -> None:
        self._close("sentence")
        self.sentence_start = len(self.done)

    def _on_seq(self, token: Token, at: int) -> None:
        at_start = self.frame.empty and len(self.done) == self.sentence_start
        if token.value == "then":
            self._close()
        elif token.value == "first":
            if self.frame.moving and self._ends(at + 1):
                self.frame.leads = self.frame.moving[-1] if self.frame.moving[-1].names_part else None
                if self.frame.elliptical and self.frame.leads is not None and not self.frame.placed and self.done:
                    self.done[-1][1].leads = self.frame.leads
                    self.frame = Frame()
        elif token.value == "start":
            self.role = "leads"
        elif token.value == "after" and not at_start:
            self._close("earlier")
        elif token.value == "before" and at_start:
            self._close("later")
        elif token.value == "before":
            self._close()
        elif token.value == "butfirst":
            self._close("earlier")

    def _ends(self, at: int) -> bool:
        return at >= len(self.tokens) or self.tokens[at].category in ("stop", "join", "seq", "but")

    def _ordinal(self, at: int) -> bool:
        """``second`` is a quantity only before a part: ``the second sleeve``."""
        token = self.tokens[at]
        if token.text == "second" or token.text == "third":
            following = self.tokens[at + 1] if at + 1 < len(self.tokens) else None
            if (
                token.text == "third"
                and self.frame.empty
                and (following is None or following.category in ("join", "verb"))
            ):
                self._close()
                return True
            return token.text == "second" and (
                following is None or following.category not in ("noun", "side", "pronoun")
            )
        return False

    # Verbs -----------------------------------------------------------------------------------------------------------

    def _on_verb(self, token: Token, at: int) -> None:
        value = token.value
        if value.startswith("bad"):
            self.frame.refused.append(token.text)
            return
        if value == "leave":
            if self.frame.verbs or self.frame.placed:
                self._close()
            self.frame.negated = True
            self.frame.verbs.append("leave")
            self.role = "moving"
            return
        if value == "meet":
            self.frame.verbs.append("meet")
            self.role = "target"
            return
        if self._begins_clause(token):
            grasped = self.frame.moving if self.frame.verbs == ["grasp"] and not self.frame.placed else []
            if grasped:
                self.frame.verbs = []
            else:
                self._close()
        if value == "halve":
            self.frame.fractions.append("half")
        if value == "quarter":
            self.frame.fractions.append("quarter")
        self.frame.verbs.append(value)
        self.role = "target" if self.role == "target" and self.purpose else "moving"

    def _begins_clause(self, token: Token) -> bool:
        frame = self.frame
        if self.purpose or not (frame.verbs or frame.moving or frame.placed or frame.fractions):
            return False
        if frame.negated and not frame.verbs:
            return False
        if not frame.verbs:
            return frame.placed and self.joined and bool(frame.moving)
        if frame.verbs == ["grasp"]:
            return True
        return self.joined or token.form != "ing" or not frame.moving

    # Noun phrases ----------------------------------------------------------------------------------------------------

    def _add_phrase(self, phrase: NounPhrase, after: int) -> None:
        self.garments += phrase.garments
        frame = self.frame
        if self.role == "target":
            if phrase.noun == "crease":
                self.role = "axis"
                frame.axes.append(phrase)
                return
            frame.targets.append(phrase)
            self.role = "moving"
        elif self.role == "axis":
            frame.axes.append(phrase)
            self.role = "axis" if phrase.noun == "crease" else "moving"
        elif self.role == "excluded":
            frame.excluded.append(phrase)
        elif self.role == "leads":
            frame.leads = phrase
            self.role = "moving"
        else:
            self._add_moving(phrase, after)

    def _add_moving(self, phrase: NounPhrase, after: int) -> None:
        frame = self.frame
        subject_of_meet = after < len(self.tokens) and self.tokens[after].is_("verb", "meet")
        if frame.axes and frame.axes[-1].noun == "crease" and phrase.names_part and not self.joined:
            frame.axes.append(phrase)
        elif self.purpose and frame.specific:
            frame.restated.append(phrase)
        elif self._opens_ellipsis(phrase) and not subject_of_meet:
            self._close()
            self.frame.elliptical = True
            self.frame.moving.append(phrase)
        elif phrase.noun == "crease" and not frame.placed:
            frame.axes.append(phrase)
            self.role = "axis"
        else:
            frame.moving.append(phrase)

    def _opens_ellipsis(self, phrase: NounPhrase) -> bool:
        """``fold the left edge to the middle and the right edge too``: a part after a clause that is complete."""
        frame = self.frame
        if not (self.joined and phrase.names_part and not self.purpose):
            return False
        if frame.negated or "grasp" in frame.verbs:
            return True
        return frame.specific and (frame.placed or bool(frame.fractions))

    # Small words -----------------------------------------------------------------------------------------------------

    def _on_prep(self, token: Token, at: int) -> None:
        follows = starts_noun_phrase(self.tokens, at + 1)
        value = token.value
        if value == "over":
            if follows and not (token.text == "over" and self._object_follows(at)):
                self.role = "target"
            else:
                self.frame.directions.append("over")
        elif value == "to" and follows:
            self.role = "axis" if self.role == "axis" or self._inside_axis() else "target"
        elif value in ("along", "down"):
            described = at + 1 < len(self.tokens) and self.tokens[at + 1].category == "manner"
            if follows or (described and starts_noun_phrase(self.tokens, at + 2)):
                self.role = "axis"
        elif value == "from":
            self.frame.from_source = not self.frame.axes
        elif value == "with":
            self.role = "target" if "meet" in self.frame.verbs or self.frame.directions else self.role
        elif value == "into":
            pass
        elif value == "until":
            self.purpose = True
            self.role = "moving"
        elif value == "under" or value == "beside":
            self.frame.refused.append(token.text)
        elif value == "in" and not (follows and self.tokens[at + 1].category == "noun" and self._centre(at + 1)):
            self.frame.directions.append("in")
        elif value == "in":
            self.role = "axis"

    def _centre(self, at: int) -> bool:
        return self.tokens[at].is_("noun", "centre", "midline")

    def _object_follows(self, at: int) -> bool:
        """``fold over the left edge``: the object stands after the adverb, nothing has been named yet."""
        return not self.frame.moving

    def _inside_axis(self) -> bool:
        return len(self.frame.axes) >= 1 and self.frame.axes[0].noun in ("crease", "diagonal", "armpit")

    def _on_dir(self, token: Token, at: int) -> None:
        if token.value == "out" and token.text == "out":
            return
        self.frame.directions.append(token.value)

    def _on_frac(self, token: Token, at: int) -> None:
        if self.joined and (self.frame.fractions or (self.frame.specific and self.frame.placed)) and not self.purpose:
            self._close()
        self.frame.fractions.append(token.value)

    def _on_manner(self, token: Token, at: int) -> None:
        self.frame.manners.append(token.value)

    def _on_goal(self, token: Token, at: int) -> None:
        self.frame.goals.append(token.value)

    def _on_again(self, token: Token, at: int) -> None:
        if token.value == "same":
            if not self.frame.empty and self.frame.verbs != ["move"] and self.frame.verbs:
                self._close()
            self.frame.same = True
        elif token.value == "again":
            self.frame.again = True

    def _on_times(self, token: Token, at: int) -> None:
        self.frame.times = int(token.value)

    def _on_steps(self, token: Token, at: int) -> None:
        self.steps = int(token.value)

    def _on_neg(self, token: Token, at: int) -> None:
        if starts_noun_phrase(self.tokens, at + 1):
            self.role = "excluded"
            return
        if self.frame.verbs or (self.frame.moving and self.frame.placed):
            self._close()
        self.frame.negated = True

    def _on_except(self, token: Token, at: int) -> None:
        if at + 1 < len(self.tokens) and self.tokens[at + 1].is_("verb"):
            self._close()
            self.frame.negated = True
        else:
            self.role = "excluded"

    def _on_only(self, token: Token, at: int) -> None:
        self.frame.only = True

    def _on_join(self, token: Token, at: int) -> None:
        if token.value == "or":
            self.frame.unknown.append("or")

    def _on_but(self, token: Token, at: int) -> None:
        if not self.frame.empty:
            self._close()

    def _on_loose(self, token: Token, at: int) -> None:
        if token.text in ("wearer",):
            self.frame.unknown.append("wearer")

    def _on_measure(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_number(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_unknown(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_quant(self, token: Token, at: int) -> None:
        if token.text == "second":
            self._close()
