"""What little words do to the clause at hand: *again*, *too*, *twice*, *not*, *except*, *but*, *or*, unknown ones."""

from __future__ import annotations

from polyfold_rules.frames.lookahead import order_list, verb_ahead
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.phrases import starts_noun_phrase
from polyfold_rules.words.tokens import Token

SUMMED_UP = ("block", "rectangle", "square", "strip", "store", "tidy", "envelope", "smalltriangle")
"""Goals that take several folds."""


class SmallWords(OpenClause):
    """The handlers of little words."""

    def _on_again(self, token: Token, at: int) -> None:
        if token.value == "same" and self.frame.specific and not (self.frame.verbs or self.frame.placed):
            self.frame.too = True  # "then the right edge does likewise"
        elif token.value == "same":
            if self.frame.verbs or self.frame.moving:
                self._close()
            self.frame.same = True
        elif token.value == "again":
            if self.joined and self.frame.placed:
                self._close()
            self.frame.again = True
        elif token.value == "too":
            self.frame.too = True

    def _on_times(self, token: Token, at: int) -> None:
        self.frame.times = int(token.value)

    def _on_steps(self, token: Token, at: int) -> None:
        self.steps = int(token.value)

    def _on_neg(self, token: Token, at: int) -> None:
        if starts_noun_phrase(self.tokens, at + 1):
            self.role = "excluded"
            return
        if not verb_ahead(self.tokens, at + 1):
            self._on_denied(at)
            return
        if self.frame.verbs or (self.frame.moving and self.frame.placed):
            self._close()
        self.frame.negated = True

    def _on_denied(self, at: int) -> None:
        """``not from left to right but from bottom to top``: what is denied is dropped only if a *but* replaces it."""
        rest = self.tokens[at + 1 :]
        length = next((i for i, token in enumerate(rest) if token.category in ("but", "stop")), None)
        if length is None or rest[length].category != "but":
            self.frame.unknown.append(self.tokens[at].text + " " + " ".join(token.text for token in rest[:3]))
            return
        self.skip_to = at + 1 + length + 1

    def _on_except(self, token: Token, at: int) -> None:
        if at + 1 < len(self.tokens) and self.tokens[at + 1].is_("verb"):
            self._close()
            self.frame.negated = True
        elif starts_noun_phrase(self.tokens, at + 1):
            self.role = "excluded"
        else:
            self.frame.unknown.append(token.text)

    def _on_only(self, token: Token, at: int) -> None:
        self.frame.only = True

    def _on_join(self, token: Token, at: int) -> None:
        led = order_list(self.tokens, at + 1, self.frame.moving[-1] if self.frame.moving else None)
        if token.value == "or":
            self.frame.unknown.append("or")
        elif led is not None:
            self.frame.leads, self.skip_to = led
        elif token.value == "colon" and self._complete():
            self._close("sentence")
        elif token.value == "colon" and self._announces(at):
            self.frame.announces = True
            self._close("sentence")
        elif token.value == "colon":
            split = set(self.frame.fractions) & {"third", "quarter"}
            if split:
                self._close("sentence")
            self.purpose = bool(self.frame.fractions or self.frame.goals or self.frame.axes)

    def _complete(self) -> bool:
        """Whether what stands before a colon says enough on its own: a part and its place, or *like a cupboard*."""
        named = {"cupboard", "envelope"} & set(self.frame.manners)
        return bool(named or (self.frame.specific and (self.frame.verbs or self.frame.placed)))

    def _announces(self, at: int) -> bool:
        """``fold it into a block: right sleeve in, left sleeve in, hem up``: what follows spells out several folds."""
        sums_up = self.frame.times > 1 or bool(set(self.frame.goals) & set(SUMMED_UP))
        rest = self.tokens[at + 1 :]
        length = next((i for i, token in enumerate(rest) if token.category == "stop"), len(rest))
        return sums_up and not self.frame.specific and any(t.category in ("join", "seq") for t in rest[:length])

    def _on_loose(self, token: Token, at: int) -> None:
        if token.text in ("wearer",):
            self.frame.unknown.append("wearer")

    def _on_measure(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_number(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_unknown(self, token: Token, at: int) -> None:
        following = self.tokens[at + 1].category if at + 1 < len(self.tokens) else ""
        if token.form == "adjective" and following in ("noun", "side", "garment", "goal"):
            self.passed.append(token.text)
        else:
            self.frame.unknown.append(token.text)

    def _on_quant(self, token: Token, at: int) -> None:
        if token.text == "second":
            self._close()
