"""From tagged tokens to clauses in the order in which they are to be done."""

from __future__ import annotations

from collections.abc import Sequence

from polyfold_rules.frames.frame import Request, in_order
from polyfold_rules.frames.lookahead import LINES, side_before_side
from polyfold_rules.frames.noun_phrases import NounPhrases
from polyfold_rules.frames.order_words import OrderWords
from polyfold_rules.frames.prepositions import Prepositions
from polyfold_rules.frames.result_words import ResultWords
from polyfold_rules.frames.small_words import SmallWords
from polyfold_rules.frames.verbs import Verbs
from polyfold_rules.words.phrases import NounPhrase, noun_phrase, starts_noun_phrase
from polyfold_rules.words.tokens import Token


def frames_of(tokens: Sequence[Token]) -> Request:
    """Assemble the clauses of a tagged instruction."""
    return _Assembler(tokens).run()


class _Assembler(Verbs, NounPhrases, Prepositions, ResultWords, OrderWords, SmallWords):
    """Walks over the tokens once; each category of words has its handler."""

    def run(self) -> Request:
        at = 0
        while at < len(self.tokens):
            if at < self.skip_to:
                at += 1
                continue
            token = self.tokens[at]
            if side_before_side(self.tokens, at):
                self.frame.leads = NounPhrase(sides=(frozenset({token.value}),))
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

    def _named_next(self, at: int) -> bool:
        """``half the towel``, with a missing letter."""
        return at + 1 < len(self.tokens) and self.tokens[at + 1].category in ("garment", "pronoun", "goal")

    def _on_stop(self, token: Token, at: int) -> None:
        self._close("sentence")
        self.sentence_start = len(self.done)

    def _on_ordinal(self, token: Token, at: int) -> None:
        self.frame.unknown.append(token.text)

    def _on_skip(self, token: Token, at: int) -> None:
        pass
