"""From tagged tokens to clauses in the order in which they are to be done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from polyfold_rules.words.frames import Frame, Request, in_order
from polyfold_rules.words.lookahead import (
    LAYING,
    LINES,
    SEAMS,
    SHAPES,
    SPANS,
    described,
    is_centre,
    keeps_manner,
    side_before_side,
    singled_out,
)
from polyfold_rules.words.ordering import OrderWords
from polyfold_rules.words.phrases import NounPhrase, noun_phrase, starts_noun_phrase
from polyfold_rules.words.tokens import Token


def frames_of(tokens: Sequence[Token]) -> Request:
    """Assemble the clauses of a tagged instruction."""
    return _Assembler(tokens).run()


class _Assembler(OrderWords):
    """Walks over the tokens once; ``role`` is what the next noun phrase will be."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.tokens = tokens
        self.done: list[tuple[str, Frame]] = []
        self.frame = Frame()
        self.order = "then"
        self.role = "moving"
        self.purpose = False
        self.spanning = False
        self.spanning_from = False
        self.shaping = False
        self.joined = False
        self.comma = False
        self.laying = False
        self.grasped = False
        self.target_last = False
        self.contrasted = False
        self._named_last = False
        self._line_last = False
        self._lead_last = False
        self._moving_last = False
        self.axis_open = True
        self.sentence_start = 0
        self.skip_to = 0
        self.garments: list[str] = []
        self.several = False
        self.passed: list[str] = []
        self.steps: int | None = None

    def run(self) -> Request:
        at = 0
        while at < len(self.tokens):
            if at < self.skip_to:
                at += 1
                continue
            token = self.tokens[at]
            if side_before_side(self.tokens, at):
                self._lead(NounPhrase(sides=(frozenset({token.value}),)))
                at += 3
                continue
            follows = starts_noun_phrase(self.tokens, at + 1)
            from_here = at + 1 < len(self.tokens) and (
                self.tokens[at + 1].is_("prep", "from", "until", "along") or self.tokens[at + 1].is_("join", "comma")
            )
            if token.text == "half" and self.frame.empty and self._named_next(at):
                self.frame.verbs.append("halve")
                self.frame.fractions.append("half")
                at += 1
                continue
            if token.text in ("crease", "quarter") and self.frame.empty and (follows or from_here):
                self.frame.verbs.append("crease" if token.text == "crease" else "fold")
                self.frame.fractions += ["quarter"] if token.text == "quarter" else []
                at += 1
                continue
            if starts_noun_phrase(self.tokens, at) and not self._ordinal(at) and not self._shape(at):
                phrase, at = noun_phrase(self.tokens, at)
                was_target = self.role == "target"
                self._add_phrase(phrase, at)
                self.target_last = was_target
                self._moving_last = bool(self.frame.moving) and self.frame.moving[-1] is phrase
                self._line_last = bool(self.frame.axes) and self.frame.axes[-1] is phrase and phrase.noun in LINES
                self.joined = False
                self._named_last, self._lead_last = True, self.frame.leads is phrase
                continue
            getattr(self, f"_on_{token.category}")(token, at)
            self._named_last = self._line_last = self._lead_last = False
            self.comma = token.is_("join", "comma")
            self.joined = token.is_("join") or (self.joined and token.category in ("neg", "quant"))
            at += 1
        self._close()
        return Request(in_order(self.done), self.garments, self.steps, self.several, tuple(self.passed))

    # Order -----------------------------------------------------------------------------------------------------------

    def _close(self, order: str = "then") -> None:
        if self.frame.empty and self.frame.leads is not None:
            self.frame.moving.append(self.frame.leads)
        if not self.frame.empty:
            self.done.append((self.order, self.frame))
            self.order = order
        elif order != "then":
            self.order = order
        self.frame = Frame()
        self.role, self.purpose, self.spanning, self.shaping = "moving", False, False, False
        self.spanning_from = self.contrasted = False

    def _on_stop(self, token: Token, at: int) -> None:
        self._close("sentence")
        self.sentence_start = len(self.done)

    def _named_next(self, at: int) -> bool:
        """``half the towel``, with a missing letter."""
        return at + 1 < len(self.tokens) and self.tokens[at + 1].category in ("garment", "pronoun", "goal")

    # Verbs -----------------------------------------------------------------------------------------------------------

    def _on_verb(self, token: Token, at: int) -> None:
        value = token.value
        if token.text == "tip" and at and self.tokens[at - 1].is_("prep", "to"):
            self.role = "target"
            return
        begun = self.frame.leads is not None and not self.frame.specific
        if token.form == "ing" and begun and self._lead_last:
            first, self.frame.leads = self.frame.leads, None
            self._close()
            self.frame.moving.append(first)
        if value == "cover" and self.frame.specific and not self.joined:
            self.frame.verbs.append("meet")
            self.role = "target"
            return
        if self.shaping and value == "tidy":
            self.frame.goals.append("tidy")
            return
        if token.text.startswith(("slant", "angl", "slop", "tilt", "skew", "inclin")):
            self.frame.manners.append("slanted")
        if value == "bad hang" and self.purpose and self.frame.specific:
            return
        if value.startswith("bad"):
            self.frame.refused.append(token.text)
            return
        if value == "leave" and token.form == "ing" and keeps_manner(self.tokens, at + 1):
            return
        if value == "leave":
            if self.frame.verbs or self.frame.placed:
                self._close()
            self.frame.negated = True
            self.frame.verbs.append("leave")
            self.role = "moving"
            return
        if self.role == "spanned" or (token.text in SPANS and self.frame.axes and not self.frame.targets):
            self.role = "axis"
            return
        if value == "meet" and self.frame.negated:
            return
        if value == "meet":
            self.frame.verbs.append("meet")
            self.role = "target" if self.frame.moving or self.purpose else "moving"
            return
        if self._begins_clause(token):
            grasped = self.frame.moving if self.frame.verbs == ["grasp"] and not self.frame.placed else []
            if grasped:
                self.frame.verbs, self.frame.grasped, self.grasped = [], True, True
            else:
                self._close()
        self.shaping = value == "make"
        self.axis_open = False
        self.laying = token.text.startswith(LAYING)
        if value == "halve" and not (self.purpose and self.frame.specific):
            self.frame.fractions.append("half")
        if value == "quarter":
            self.frame.fractions.append("quarter")
        self.frame.verbs.append(value)
        if value == "cover":
            self.role = "target"
            return
        self.role = "target" if self.role == "target" and self.purpose else "moving"

    def _begins_clause(self, token: Token) -> bool:
        frame = self.frame
        explains = token.form == "ing" and (
            (not frame.specific and (frame.fractions or frame.goals or frame.axes or (self.comma and frame.manners)))
            or (self.comma and frame.specific and bool(frame.verbs))
        )
        explains = explains or (token.form == "past" and self.comma and frame.specific and "meet" in frame.verbs)
        if explains:
            self.purpose = True
        complete = frame.specific and frame.placed and token.form == "base" and token.value in ("fold", "move", "turn")
        if self.purpose and self.joined and not self.comma and complete:
            return True
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
        self.several |= bool(phrase.garments and not phrase.noun and (phrase.number or 1) > 1)
        self.several |= bool(phrase.garments and phrase.quantity == "other")
        self.shaping = False
        frame = self.frame
        only_counts = phrase.quantity in ("each", "both", "all") and not (phrase.names_it or phrase.number)
        if only_counts and frame.moving:
            frame.shared = not (frame.moving[-1].plural or frame.placed)
            return
        if only_counts:
            phrase = replace(phrase, quantity=None, pronoun="them")
        if self.target_last and self.joined and len(frame.moving) > 1 and phrase.names_part:
            frame.targets.append(phrase)
            return
        if self.role == "held":  # "hold the hem at both ends"
            self.role = "moving"
            return
        if self.spanning and self.joined:
            frame.axes.append(phrase)
            return
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
        if phrase.noun in SEAMS or phrase.noun == "crease":
            frame.axes.append(phrase)
            self.role, self.axis_open = "axis" if phrase.noun == "crease" else "moving", True
            return
        if self._restates(phrase):
            frame.restated.append(phrase)
            self.purpose = True
            return
        if self.grasped and phrase.pronoun and not (phrase.sides or phrase.noun or phrase.quantity == "other"):
            frame.restated.append(phrase)
            return
        if self.grasped and phrase.names_part and phrase.noun not in ("body", "centre", "midline", *SHAPES, *LINES):
            frame.moving, self.grasped = [phrase], False
            return
        if phrase.noun in ("body", "centre", "midline") and frame.moving and not frame.targets:
            frame.targets.append(phrase)
            return
        if phrase.noun in ("third", "quarter") and phrase.plural and not phrase.sides and not frame.specific:
            frame.fractions.append(phrase.noun)
            return
        if phrase.quantity == "other" and phrase.text == "another" and not (phrase.noun or phrase.sides):
            frame.again = True
            return
        subject_of_meet = after < len(self.tokens) and self.tokens[after].is_("verb", "meet")
        if (
            frame.axes
            and phrase.names_part
            and not self.joined
            and (self._line_last or (frame.axes[-1].noun == "crease" and self.axis_open))
        ):
            frame.axes.append(phrase)
        elif (self.purpose and frame.specific) or (frame.negated and frame.moving and phrase.pronoun == "it"):
            frame.restated.append(phrase)
            if phrase.sides and frame.leads is None and singled_out(frame.moving[0], phrase):
                frame.leads = phrase
        elif self._opens_ellipsis(phrase) and not subject_of_meet:
            aside = self.comma
            self._close()
            self.frame.elliptical, self.frame.aside = True, aside
            self.frame.moving.append(phrase)
        else:
            frame.moving.append(phrase)

    def _restates(self, phrase: NounPhrase) -> bool:
        """``..., its tip toward the hem``: a detail of the part that moves already."""
        nouns = {p.noun for p in (*self.frame.moving, self.frame.leads) if p is not None}
        bare = not (phrase.sides or phrase.quantity or phrase.number)
        tip = "sleeve" in nouns and phrase.noun in ("cuff", "tip", "edge") and not phrase.sides
        tip |= phrase.noun == "tip" and bare and self.frame.specific
        return tip or (self.purpose and bare and bool(self.frame.axes) and phrase.noun == "sleeve")

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
        elif value == "to" and (follows or described(self.tokens, at)):
            self.role = "axis" if self.role == "axis" or self._inside_axis() else "target"
        elif value == "to" and self._infinitive(at):
            self.purpose = True
        elif token.text in ("at", "by") and self.frame.verbs == ["grasp"] and self.frame.specific:
            self.role = "held"
        elif value in ("along", "down"):
            if (follows or described(self.tokens, at)) and self.role != "target":
                lies = self.purpose and bool(self.frame.restated) and is_centre(self.tokens, at + 1)
                placing = (self.laying and token.text in ("along", "at", "down along")) or lies
                self.role = "target" if placing else "axis"
        elif value == "from":
            self.frame.from_source = not self.frame.axes
            if self._line_last or self.frame.verbs == ["crease"]:
                self.role, self.spanning_from = "axis", True
        elif value == "with" and "meet" in self.frame.verbs:
            self.role = "target"
        elif value == "with":
            self.purpose = self.purpose or (follows and not self.frame.same)
        elif value == "where":
            self.role = "target" if follows else self.role
            self.purpose = self.purpose or not follows
        elif value == "between":
            self.role, self.spanning = "axis", True
        elif value == "into":
            self._on_into(at)
        elif value == "until":
            self.purpose = True
            self.role = "moving"
        elif value == "under" or value == "beside":
            self.frame.refused.append(token.text)
        elif value == "in" and not (
            follows and self.tokens[at + 1].category == "noun" and is_centre(self.tokens, at + 1)
        ):
            self.frame.directions.append("in")
        elif value == "in":
            self.role = "target" if self.purpose and self.frame.restated else "axis"

    def _infinitive(self, at: int) -> bool:
        """``bring the bottom up to the top to halve it``: what a complete clause is done for."""
        verb = at + 1 < len(self.tokens) and self.tokens[at + 1].is_("verb")
        return verb and self.tokens[at].text == "to" and self.frame.specific and self.frame.placed

    def _on_into(self, at: int) -> None:
        """``into the middle`` is a place, ``into a triangle`` a shape."""
        ahead = at + 1
        while ahead < len(self.tokens) and self.tokens[ahead].category in ("side", "number"):
            ahead += 1
        if ahead < len(self.tokens) and self.tokens[ahead].is_("noun") and not self.tokens[ahead].is_("noun", *SHAPES):
            self.role = "target"
        else:
            self.shaping = True

    def _shape(self, at: int) -> bool:
        """Whether the noun here is a shape to be made."""
        return self.shaping and self.tokens[at].is_("noun", *SHAPES)

    def _on_noun(self, token: Token, at: int) -> None:
        self.frame.goals.append({"result": "strip"}.get(token.value, token.value))
        self.shaping = False

    def _lead(self, phrase: NounPhrase) -> None:
        self.frame.leads = phrase

    def _object_follows(self, at: int) -> bool:
        """``fold over the left edge``: the object stands after the adverb, nothing has been named yet."""
        return not self.frame.moving

    def _inside_axis(self) -> bool:
        if self._moving_last and self.frame.axes:
            return False
        return self.spanning_from or (
            bool(self.frame.axes) and self.frame.axes[0].noun in ("crease", "diagonal", "armpit")
        )

    def _on_dir(self, token: Token, at: int) -> None:
        self.frame.directions.append(token.value)
        self.frame.phrasal |= token.text == "up"

    def _on_ordinal(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_frac(self, token: Token, at: int) -> None:
        complete = self.frame.specific and self.frame.placed
        explained = self.purpose and not (complete and self.frame.fractions)
        last = at + 1 >= len(self.tokens) or self.tokens[at + 1].category == "stop"
        sums_up = self.comma and last and not self.frame.fractions  # "left over right, in half"
        if self.joined and (self.frame.fractions or complete) and not (explained or sums_up):
            self._close()
        self.frame.fractions.append(token.value)

    def _on_manner(self, token: Token, at: int) -> None:
        self.frame.manners.append(token.value)

    def _on_goal(self, token: Token, at: int) -> None:
        if token.value in ("square", "rectangle") and token.text == token.value and not self.shaping:
            self.garments.append(token.value)
            return
        self.frame.goals.append(token.value)
        self.shaping = self.shaping and token.value == "tidy"

    def _on_skip(self, token: Token, at: int) -> None:
        pass
