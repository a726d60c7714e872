"""What verbs do to the clause at hand: most begin a new one, some say how or where the fold ends."""

from __future__ import annotations

from polyfold_rules.frames.lookahead import LAYING, SPANS, keeps_manner
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.tokens import Token


class Verbs(OpenClause):
    """The handler of verbs."""

    def _on_verb(self, token: Token, at: int) -> None:
        value = token.value
        if token.text == "tip" and at and self.tokens[at - 1].is_("prep", "to"):
            self.role = "target"
            return
        first = self.frame.leads
        if token.form == "ing" and first is not None and not self.frame.specific and self._lead_last:
            self.frame.leads = None
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
