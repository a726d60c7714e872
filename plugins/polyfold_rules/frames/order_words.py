"""Words that tell in which order clauses are done: *then*, *first*, *before*, *after*, *but first*, *starting with*."""

from __future__ import annotations

from polyfold_rules.frames.frame import Frame
from polyfold_rules.frames.lookahead import clause_ends, order_list
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.phrases import starts_noun_phrase
from polyfold_rules.words.tokens import Token


class OrderWords(OpenClause):
    """The handlers of order words."""

    def _on_seq(self, token: Token, at: int) -> None:
        at_start = self.frame.empty and len(self.done) == self.sentence_start
        if token.value == "then":
            self._close()
        elif token.value == "first" and self._comes_earlier(at):
            self.order = "earlier"
        elif token.value == "first":
            self._comes_first(at)
        elif token.value == "start":
            self._starts_with(at)
        elif token.value == "after" and not (
            starts_noun_phrase(self.tokens, at + 1) or (at + 1 < len(self.tokens) and self.tokens[at + 1].is_("verb"))
        ):
            pass
        elif token.value == "after" and not at_start:
            self._close("earlier")
        elif token.value == "before" and at_start:
            self._close("later")
        elif token.value == "before":
            self._close()
        elif token.value == "butfirst":
            self._close("earlier")

    def _starts_with(self, at: int) -> None:
        """``..., starting with the right one and then the left``."""
        led = order_list(self.tokens, at + 1, self.frame.moving[-1] if self.frame.moving else None)
        if led is None:
            self.role = "leads"
        else:
            self.frame.leads, self.skip_to = led

    def _comes_earlier(self, at: int) -> bool:
        """``..., but fold the sleeves in first``: not when what comes second follows."""
        last = at + 1 >= len(self.tokens) or self.tokens[at + 1].category == "stop"
        ends = last or (self.contrasted and clause_ends(self.tokens, at + 1))
        return ends and bool(self.frame.verbs and self.done) and not self._named_last

    def _comes_first(self, at: int) -> None:
        """``..., the left one first``: the part that is done first of those named before."""
        frame = self.frame
        if self.purpose and frame.moving and not frame.verbs:
            frame.leads = frame.moving.pop()
            self.purpose = False
        elif frame.restated and frame.leads is frame.restated[-1]:
            pass
        elif frame.moving and clause_ends(self.tokens, at + 1):
            frame.leads = frame.moving[-1] if frame.moving[-1].names_part else None
            if frame.elliptical and frame.leads is not None and not frame.placed and self.done:
                self.done[-1][1].leads = frame.leads
                self.frame = Frame()

    def _on_but(self, token: Token, at: int) -> None:
        """``but only halfway``, ``but stop at the middle`` limits the clause, any other is a new one."""
        following = self.tokens[at + 1] if at + 1 < len(self.tokens) else token
        limits = following.is_("only") or (following.is_("verb", "meet") and not self.frame.targets)
        if not self.frame.empty and not limits:
            self._close()
            self.contrasted = True

    def _ordinal(self, at: int) -> bool:
        """``second`` is a quantity only before a part: ``the second sleeve``."""
        following = self.tokens[at + 1] if at + 1 < len(self.tokens) else None
        text = self.tokens[at].text
        if text == "third" and self.frame.empty and (following is None or following.category in ("join", "verb")):
            self._close()
            return True
        return text == "second" and (
            following is None or following.category not in ("noun", "side", "pronoun", "garment")
        )
