"""What noun phrases are in the clause at hand: what moves, where it goes, along which line, or a detail."""

from __future__ import annotations

from dataclasses import replace

from polyfold_rules.frames.lookahead import LINES, SEAMS, SHAPES, singled_out
from polyfold_rules.frames.open_clause import OpenClause
from polyfold_rules.words.phrases import NounPhrase


class NounPhrases(OpenClause):
    """The handler of noun phrases."""

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
