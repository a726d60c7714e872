"""What words for results do to the clause at hand: shapes, fractions, directions, manners."""

from __future__ import annotations

from polyfold_rules.frames.lookahead import SHAPES
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.tokens import Token


class ResultWords(OpenClause):
    """The handlers of shapes, fractions, directions and manners."""

    def _shape(self, at: int) -> bool:
        """Whether the noun here is a shape to be made."""
        return self.shaping and self.tokens[at].is_("noun", *SHAPES)

    def _on_noun(self, token: Token, at: int) -> None:
        self.frame.goals.append({"result": "strip"}.get(token.value, token.value))
        self.shaping = False

    def _on_goal(self, token: Token, at: int) -> None:
        if token.value in ("square", "rectangle") and token.text == token.value and not self.shaping:
            self.garments.append(token.value)
            return
        self.frame.goals.append(token.value)
        self.shaping = self.shaping and token.value == "tidy"

    def _on_frac(self, token: Token, at: int) -> None:
        complete = self.frame.specific and self.frame.placed
        explained = self.purpose and not (complete and self.frame.fractions)
        last = at + 1 >= len(self.tokens) or self.tokens[at + 1].category == "stop"
        sums_up = self.comma and last and not self.frame.fractions  # "left over right, in half"
        if self.joined and (self.frame.fractions or complete) and not (explained or sums_up):
            self._close()
        self.frame.fractions.append(token.value)

    def _on_dir(self, token: Token, at: int) -> None:
        self.frame.directions.append(token.value)
        self.frame.phrasal |= token.text == "up"

    def _on_manner(self, token: Token, at: int) -> None:
        self.frame.manners.append(token.value)
