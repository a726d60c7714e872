"""Parts in turns of phrase that are read only once the grammar of folds has given up: what must not show or stick out.

They may use words of folding (*one sleeve tucked in*) without taking a sentence from that grammar.
"""

from __future__ import annotations

import re

from polyfold_rules.wishes.parts import SIDE
from polyfold_rules.wishes.readers import Reader, hides, nothing, one_sleeve, shortened
from polyfold_rules.wishes.wish import Wish


def _one_corner(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("dogear")


def _pointed(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("arrow")
    wish.points = {"upper": "top", "lower": "bottom"}.get(match.group("side"), match.group("side"))


def _legs_together(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("oneleg")


PART_IDIOMS: list[tuple[str, Reader]] = [
    (r"(?:the |its |both |those |these |my |no )*(?:(?P<side>left|right) )?(?:sleeves?|arms?) (?:do|does|will"
     r"|would|may|can"
     r"|should|must) (?:not |no longer )(?:be )?(?:show|shown|showing|seen|visible|stick out|appear|hang out"
     r"|poke out|peek out)"
     r"(?: out)?", hides),
    (r"(?:the |its |their |both )*(?:trouser |pant )?legs? (?:should |must |to |be |are |is |have |need |a bit "
     r"|a lot |much |"
     r"way |far |too |half (?:as )?)*(?:shorter|shortened|short|too long|long)", shortened),
    (r"(?:(?:nobody|no one|noone|none) (?:should |must |may |can |will |is to |has to |needs to |wants to |would )*"
     r"(?:see|notice|spot|look at|be able to see)|(?:conceal|concealing|cover up|covering up|put away|tuck away"
     r"|clear away|"
     r"do away with|not have|not want|not need|not like|away with|minus|free of|rid of)) (?:the |its |any "
     r"|both |of |my |"
     r"those |these |her |his )*(?:(?P<side>left|right) )?(?:sleeves?|arms?)(?: any ?more| anywhere| at all"
     r"| hanging out|"
     r" sticking out| dangling)*(?! (?:to be |be )?(?:folded|tucked|moved|touched|turned|bent|creased|in)\b)",
     hides),
    (r"(?:the |its |both |those |these |my )*(?:(?P<side>left|right) )?(?:sleeves?|arms?) (?:should |must |may "
     r"|can |are |"
     r"is |be |to |get |have |has |need |needs |want |only |just )*(?:not stick(?:ing)? out|in the way|annoying"
     r"|concealed|"
     r"covered(?: up)?|nowhere to be seen|not (?:hang|dangle|flap)(?:ing)?(?: out| about| around)?|put away|inside)",
     hides),
    (r"(?:just |only |exactly |simply )*(?:one|a single|either|any one|any)(?: of the| of its)? (?:sleeves?|arms?) "
     r"(?:folded |tucked |turned |put |to be |should be |should |must |be |to |go |is )*(?:in|away|inside|gone"
     r"|hidden|over|"
     r"missing|off)", one_sleeve),
    (r"(?:just |only |exactly |simply )*(?:one|a single|any one|any|a)(?: of the"
     r"| of its)?(?: four)? corners? (?:folded |"
     r"tucked |turned |put |to be |should be |should |must |be |to |go |is |bent )*(?:in|away|inside|gone"
     r"|hidden|missing|"
     r"off|down|cut off|snipped off)|dog ?eared?(?: page)?", _one_corner),
    (rf"(?:the |its |at the |a )*(?P<side>{SIDE})(?: of it| of the \w+| end| edge| side| part)? (?:should "
     rf"|must |is to |to "
     r"|ought to |can |be |look |looks |looking |like |come |comes |end |ends |run |runs |have |has |form "
     r"|forms |in |into |a "
     r"|an |the )+(?:roof(?: of a (?:house|barn|hut))?|pointy|pointed|point|tip|gable|arrow(?:head)?|peak"
     r"|spike)", _pointed),
    (r"(?:one|either) leg (?:lying |laid |should be |should lie |is |placed )*(?:on top of|over|onto|on"
     r"|covering) the other"
     r"|(?:the |both )*legs (?:lying |should |lie |be |are |go |laid )*(?:together|on top of (?:each other"
     r"|one another))",
     _legs_together),
    (r"(?:the |their |its |both )*(?:legs?|cuffs?|hems?|bottoms?|ends?) (?:are |is |should |must |may |can |do "
     r"|does |would |"
     r"not |keep |always |just )*(?:drag|drags|dragging|trail|trails|trailing|touch|touching|on|reach|hanging"
     r"|hang)(?: on| "
     r"along| over| down to| in)? the (?:floor|ground|carpet|mud|dirt)", nothing),
]  # fmt: skip
