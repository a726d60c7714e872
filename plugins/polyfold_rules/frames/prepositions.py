"""What prepositions tell of the next noun phrase: a place, a line, a purpose, a shape."""

from __future__ import annotations

from polyfold_rules.frames.lookahead import SHAPES, described, is_centre
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.phrases import starts_noun_phrase
from polyfold_rules.words.tokens import Token


class Prepositions(OpenClause):
    """The handler of prepositions."""

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

    def _object_follows(self, at: int) -> bool:
        """``fold over the left edge``: the object stands after the adverb, nothing has been named yet."""
        return not self.frame.moving

    def _inside_axis(self) -> bool:
        if self._moving_last and self.frame.axes:
            return False
        return self.spanning_from or (
            bool(self.frame.axes) and self.frame.axes[0].noun in ("crease", "diagonal", "armpit")
        )
