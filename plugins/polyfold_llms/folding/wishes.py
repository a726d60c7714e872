"""What an instruction wants the end to be, if it leaves the folds open: sizes, shapes, purposes, parts that vanish.

A wish is read only if every word is accounted for: what is neither part of a wish nor a word without meaning here may
stand only as an adjunct (*for the shelf in the bathroom*). Anything else is left to the grammar of folds, or refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files

from polyfold_llms.folding.lexicon import fillers, phrases
from polyfold_llms.folding.spelling import NUMBERS, plainest

__all__ = ["Bound", "Wish", "read_wish"]

FRACTIONS = {
    "half": 1 / 2, "third": 1 / 3, "quarter": 1 / 4, "fourth": 1 / 4, "fifth": 1 / 5, "sixth": 1 / 6, "eighth": 1 / 8,
    "two thirds": 2 / 3, "three quarters": 3 / 4,
}  # fmt: skip
QUANTITIES = {
    "area": "size sizes area footprint surface space room big bigger large larger small smaller compact",
    "width": "width wide wider narrow narrower broad broader breadth slim slimmer",
    "height": "height high higher tall taller",
    "length": "length long longer short shorter",
}
QUANTITY = {word: name for name, words in QUANTITIES.items() for word in words.split()}

A = r"(?:a |an |one |its |their |just |only |about |roughly |around |to |by |down |the )*"
FRACTION = r"(?P<share>two thirds|three quarters|half|third|quarter|fourth|fifth|sixth|eighth)"
NOUN = r"(?P<dim>size|sizes|area|footprint|surface|space|room|width|breadth|height|length)"
DIM = rf"(?P<dim>{'|'.join(QUANTITY)})"
OF = r"(?:of |in |the |its |their |it |his |her |original |present |current |full |flat |whole |own |total )*"
CLOTH = (
    r"(?:what (?:it|they) (?:is|are|was|were)(?: now)?|(?:cloth|towel|napkin|shirt|tee|tshirt|pants|trousers|jeans"
    r"|garment|fabric|square|rectangle|thing)\b)"
)
NUMBER = rf"(?P<number>\d|{'|'.join(NUMBERS)}|single)"
STEP = r"(?:steps?|folds?|moves?|stages?|goes|foldings?|movements?)"
SIDE = r"(?:top|bottom|left|right|upper|lower)"
EDGES = {"upper": "top", "lower": "bottom", "waistband": "top", "waist": "top", "collar": "top", "neck": "top",
         "hem": "bottom", "shoulders": "top", "ankles": "bottom"}  # fmt: skip
KEPT = rf"(?P<kept>(?:{SIDE})(?: edge| side| border)?|waistband|waist|collar|hem|shoulders)"
GONE = r"(?:gone|disappear|vanish|hidden|invisible|tucked away|out of (?:sight|the way|view))"
UNSEEN = r"(?:hide|hiding|lose|without|no|not want to see|not see|remove|get rid of|nothing of|rid of)"


@dataclass(frozen=True)
class Bound:
    """A ratio to the flat garment that the end must keep; ``aim`` is the value wished for, if it is one."""

    quantity: str
    low: float = 0.0
    high: float = 9.0
    aim: float | None = None


@dataclass
class Wish:
    """What the end should be; what is None or empty was not said.

    Attributes:
        bounds: ratios that it must keep.
        looks: what it should resemble, by the names of ``wishes.txt``.
        shapes: ``triangle``, ``square``, ``rectangle``, ``strip``.
        purposes: what it is for.
        hidden: sleeves that must not stick out, or corners that must be folded in.
        kept: edges that must stay where they are.
        lies: sides of the flat garment's place that it should lie on.
        points: the side to which it should point.
        steps: (least, most) number of folds.
        small: it should be small.
        least: it should be as small as can be.
        words: what the wish was read from, as said.
        passed: unknown words in adjuncts, which tell nothing about the end.
    """

    bounds: list[Bound] = field(default_factory=list)
    looks: list[str] = field(default_factory=list)
    shapes: list[str] = field(default_factory=list)
    purposes: list[str] = field(default_factory=list)
    hidden: set[str] = field(default_factory=set)
    kept: set[str] = field(default_factory=set)
    lies: set[str] = field(default_factory=set)
    points: str = ""
    steps: tuple[int, int] | None = None
    small: bool = False
    least: bool = False
    words: list[str] = field(default_factory=list)
    passed: list[str] = field(default_factory=list)

    @property
    def says_something(self) -> bool:
        """Whether it wants anything of the end; a number of folds alone does not."""
        return bool(
            self.bounds or self.looks or self.shapes or self.purposes or self.hidden or self.lies or self.points
            or self.small or self.least
        )  # fmt: skip

    @property
    def sized(self) -> bool:
        """Whether it says how large the end should be."""
        return bool(self.bounds)


LIKE = r"(?:like|into|become|becomes|as|resemble|resembles) (?:a |an |a pair of )?"

Reader = Callable[[Wish, re.Match[str]], None]


def read_wish(text: str, garment_words: frozenset[str], folds_named: bool = False) -> Wish | None:
    """The wish in an instruction, or None if it is not one, or not only.

    Args:
        text: the instruction.
        garment_words: values of the lexicon's garments that mean the one on the table.
        folds_named: allow *fold* as a verb: *fold it so that it fits in a drawer*.
    """
    words = plainest(text)
    if _CARRIES.search(words):
        return None
    wish = Wish()
    at, adjunct = 0, False
    while at < len(words):
        found = _rule_at(words, at)
        if found is not None:
            rule, match = found
            rule(wish, match)
            wish.words.append(match.group(0).strip())
            at, adjunct = match.end(), False
            continue
        word = _WORD.match(words, at)
        if word is None:
            adjunct = adjunct and words[at] == " "
            at += 1
            continue
        said = word.group(0)
        if said in _ADJUNCTS or (said in _PLACES and not folds_named):
            adjunct = True
        elif said in _vocabulary()["filler"] or (said == "fold" and folds_named):
            pass
        elif said in garment_words or _names(said, garment_words):
            adjunct = False
        elif adjunct and not _means_something(said):
            wish.passed.append(said)
        else:
            return None
        at = word.end()
    return wish if wish.says_something else None


_CARRIES = re.compile(
    r"(?:^|[.,;:] |please |and |then |you |to )(?:hang|put|place|lay|throw|carry|bring|drop|stuff|toss|stick|pop|drape"
    r"|take|pack|store|stow|move|send) (?:up |away )?(?:(?:the|this|that|these|those|my|your|it|them|a|two)\b ?)"
    r"(?:(?:\w+ )?\w+ )?(?:up|away|back|down|in|into|on|onto|over|to|inside|around)\b(?! (?:shape|form|order|half))"
)
"""The cloth is to be brought somewhere: *hang the shirt up*, *put it in the drawer*."""

_WORD = re.compile(r"[a-z0-9']+")
_ADJUNCTS = frozenset(["for", "in", "of", "at", "before", "after", "next", "near", "from", "inside", "with"])
_PLACES = frozenset(["on", "over", "under", "beside"])
"""Words that begin an adjunct, in which unknown nouns tell nothing about the shape; nothing is folded at a place."""


def _names(word: str, garment_words: frozenset[str]) -> bool:
    entries = phrases().get(word, phrases().get(word.removesuffix("s"), ()))
    return any(category == "garment" and value in garment_words and len(said) == 1 for said, category, value in entries)


def _means_something(word: str) -> bool:
    """Whether the grammar of folds knows a word, other than as one without meaning."""
    entries = [*phrases().get(word, ()), *phrases().get(word.removesuffix("s"), ())]
    known = any(len(said) == 1 and category != "garment" for said, category, _ in entries)
    return known and word not in fillers()


@cache
def _vocabulary() -> dict[str, frozenset[str]]:
    table, _, filler = files(__package__).joinpath("wishes.txt").read_text("utf-8").partition("\nfiller:\n")
    words: dict[str, frozenset[str]] = {"filler": frozenset(filler.split())}
    for line in table.splitlines():
        head, _, rest = line.partition(":")
        if rest and not line.startswith("#"):
            words[head] = frozenset(phrase.strip() for phrase in rest.split(","))
    return words


def _rule_at(words: str, at: int) -> tuple[Reader, re.Match[str]] | None:
    """The rule that takes the most words here."""
    if at and words[at - 1].isalnum():
        return None
    found = [(rule, match) for pattern, rule in _rules() if (match := pattern.match(words, at)) is not None]
    return max(found, key=lambda pair: pair[1].end(), default=None)


@cache
def _rules() -> list[tuple[re.Pattern[str], Reader]]:
    known = [(_any_of(head, words), _known(*head.split())) for head, words in _vocabulary().items() if head != "filler"]
    return known + [(re.compile(pattern + r"\b"), rule) for pattern, rule in _GRAMMAR]


_BEFORE = {
    "worn": LIKE,
    "shape": r"(?<!\bthe )(?<!\bthis )(?<!\bmy )",
    "purpose pocket": r"(?:for|in|into) (?:a |the |my |your |his |her |our )?",
}
"""What must stand before words of a kind for them to be meant: *the square* is the cloth, *a square* a shape."""


def _any_of(head: str, words: frozenset[str]) -> re.Pattern[str]:
    before = _BEFORE.get(head, _BEFORE.get(head.split()[0], ""))
    return re.compile(rf"{before}(?:{'|'.join(sorted(map(_plural, words), key=len, reverse=True))})\b")


def _plural(word: str) -> str:
    return re.escape(word).replace(r"\ ", " ") + "(?:e?s)?"


def _known(kind: str, value: str) -> Reader:
    def take(wish: Wish, match: re.Match[str]) -> None:
        said = {"look": wish.looks, "worn": wish.looks, "shape": wish.shapes, "purpose": wish.purposes}
        if kind == "small":
            wish.small, wish.least = True, wish.least or value == "least"
        else:
            said[kind].append(value)

    return take


# Rules of grammar ----------------------------------------------------------------------------------------------------

TOLERANCE = 1.25
"""A size that is asked for may be missed by this factor: nobody measures a quarter."""


def _share(match: re.Match[str]) -> float:
    return FRACTIONS[match.group("share")]


def _quantity(match: re.Match[str]) -> str:
    return QUANTITY.get(match.groupdict().get("dim") or "", "area")


def _about(quantity: str, value: float) -> Bound:
    return Bound(quantity, value / TOLERANCE, value * TOLERANCE, value)


def _is(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(_about(_quantity(match), _share(match)))


def _less_by(wish: Wish, match: re.Match[str]) -> None:
    share = 1 - _share(match)
    wish.bounds.append(Bound(_quantity(match), share / 1.15, share * 1.15, share))


def _at_most(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound(_quantity(match), high=_share(match) * 1.15))


def _below(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound(_quantity(match), high=_share(match) * 0.97))


def _halved(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(_about(_quantity(match), 1 / 2))


def _times_smaller(wish: Wish, match: re.Match[str]) -> None:
    number = _number(match)
    wish.bounds.append(_about(_quantity(match), 1 / max(number, 1)))


def _unchanged(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound(_quantity(match), low=0.95))


def _one_leg_wide(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("width", high=0.6))


def _body_wide(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden |= {"left", "right"}


def _number(match: re.Match[str]) -> int:
    said = match.group("number")
    return 1 if said == "single" else int(said) if said.isdigit() else NUMBERS[said]


def _steps(wish: Wish, match: re.Match[str]) -> None:
    number = _number(match)
    loose = re.search(r"most|more than|up to|will do|enough|allow|max|maximum|fewer|or less|or two", match.group(0))
    wish.steps = (1, number) if loose else (number, number)


def _as_small_as_steps_allow(wish: Wish, match: re.Match[str]) -> None:
    wish.least, wish.steps = True, (1, _number(match))


def _gate(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("gate")


def _full_width(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("width", low=0.95))


def _nothing(wish: Wish, match: re.Match[str]) -> None:
    """Words that make no difference to the end."""


def _hides(wish: Wish, match: re.Match[str]) -> None:
    side = match.groupdict().get("side")
    wish.hidden |= {side} if side else {"left", "right"}


def _only_sleeve(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden |= {"left", "right"} - {match.group("one") or match.group("other")}


def _hides_corner(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden.add("_".join(EDGES.get(word, word) for word in match.group("corner").split()[:2]))


def _keeps(wish: Wish, match: re.Match[str]) -> None:
    first = match.group("kept").split()[0]
    wish.kept.add(EDGES.get(first, first))


def _lies(wish: Wish, match: re.Match[str]) -> None:
    wish.lies |= {EDGES.get(word, word) for word in match.group("place").split()}


def _frees(wish: Wish, match: re.Match[str]) -> None:
    opposite = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}
    side = EDGES.get(match.group("place"), match.group("place"))
    wish.lies.add(opposite[side])
    wish.bounds.append(_about("width" if side in ("left", "right") else "height", 1 / 2))


def _points(wish: Wish, match: re.Match[str]) -> None:
    word = match.group("place")
    wish.points = {"up": "top", "upwards": "top", "upward": "top", "down": "bottom", "downwards": "bottom",
                   "downward": "bottom"}.get(word, EDGES.get(word, word))  # fmt: skip


_GRAMMAR: list[tuple[str, Reader]] = [
    (rf"(?:in |with |using |within |by |take |takes )?(?:at most |no more than |not more than |up to |only |just "
     rf"|exactly |as few as |max |maximum |a )*{NUMBER}(?: simple| diagonal)? {STEP}(?: at (?:most|the most)| or less"
     rf"| or fewer| will do| is enough| are enough| is plenty| allow| max| maximum)?", _steps),
    (rf"as small as {NUMBER} {STEP} allow", _as_small_as_steps_allow),
    (rf"{A}{FRACTION}(?: of)?(?: {OF})?(?: ?{DIM})(?: (?:at (?:the )?most|or less|maximum|max))", _at_most),
    (rf"{A}{FRACTION} ?{OF}{NOUN}(?: left| as before| of (?:before|now|{CLOTH}))?", _is),
    (rf"{A}{FRACTION} as {DIM}(?: as (?:before|now|it (?:is|was)|they (?:are|were))(?: now)?)?", _is),
    (rf"{A}{FRACTION} of (?:the |its |their )?{CLOTH}", _is),
    (rf"(?:down to|to|about|by|is|covers?|only|just) (?:a |an |one )?{FRACTION}(?! of| too| \w+er)", _is),
    (rf"{A}{FRACTION} too {DIM}", _less_by),
    (rf"{A}{FRACTION} (?P<dim>\w+er)(?: than (?:before|now|it is|they are))?", _less_by),
    (rf"(?:no|not|never)(?: be)?(?: any)? {DIM} than {A}{FRACTION}(?: of {CLOTH})?", _at_most),
    (rf"(?:no more|not more) than {A}{FRACTION}(?: ?{OF}{DIM})?(?: of (?:the |its |their )?{CLOTH})?", _at_most),
    (rf"at most {A}{FRACTION}(?: ?{OF}{DIM})?(?: of (?:the |its |their )?{CLOTH})?", _at_most),
    (rf"(?:less|smaller|shorter|narrower|lower) than {A}{FRACTION}(?: ?{OF}{DIM})?(?: of {CLOTH})?", _below),
    (rf"(?:halve|halving|halved) {OF}{DIM}", _halved),
    (rf"{OF}{DIM} (?:is |are |be |to be )?halved", _halved),
    (rf"{NUMBER} times {DIM}", _times_smaller),
    (rf"(?:the )?(?:full|whole|entire|same|all (?:of )?(?:the|its)) {DIM}(?: as (?:before|now))?", _unchanged),
    (rf"as {DIM} as (?:before|now|it (?:is|was)|they (?:are|were)|ever)(?: now)?", _unchanged),
    (r"(?:no (?:wider|broader) than |as (?:wide|narrow|broad) as )?(?:one|a single) leg(?: wide)?", _one_leg_wide),
    (r"(?:no|not) (?:wider|broader) than (?:its|the) (?:body|torso|trunk|chest)", _body_wide),
    (r"as (?:wide|narrow) as (?:its|the) (?:body|torso|trunk|chest)", _body_wide),
    (rf"{UNSEEN} (?:the |its |any |both |of )*(?:(?P<side>left|right) )?sleeves?(?: any ?more| showing| sticking out)*",
     _hides),
    (rf"(?:the |its |both )*(?:(?P<side>left|right) )?sleeves? (?:is |are |should |be |to |has |have )*{GONE}", _hides),
    (r"(?:the )?(?P<one>left|right) sleeve only|only (?:the |its )?(?P<other>left|right) sleeve", _only_sleeve),
    (rf"{UNSEEN} (?:the |its )?(?P<corner>(?:top|bottom|upper|lower) (?:left|right)) corner(?: any ?more)?",
     _hides_corner),
    (rf"(?:the )?(?P<corner>(?:top|bottom|upper|lower) (?:left|right)) corner (?:is |should |be |to |has )*{GONE}",
     _hides_corner),
    (rf"(?:leave|leaving|keep|keeping) (?:the |its )?{KEPT}(?: where it (?:is|was)| in place| as it is| still"
     rf"| where they are)?", _keeps),
    (rf"(?:the |its )?{KEPT} (?:should |must |can |has to |to )*(?:stays?|staying|remains?)(?: where it is| in place"
     rf"| still| put| as it is)?", _keeps),
    (rf"(?:covers?|covering|fills?|on|occup(?:y|ies)|takes? up) (?:only |just )?the "
     rf"(?P<place>{SIDE}(?: {SIDE})?)(?: half| part| side)", _lies),
    (rf"(?:with |and )?(?:its |the |a )?right angle (?:should |to |must )?(?:be |is |lies |lie |sits )?"
     rf"(?:at|in|on) the (?P<place>{SIDE} {SIDE})(?: corner)?", _lies),
    (rf"(?:need|want|free|clear|use|have|get)(?: up)? the (?P<place>{SIDE}) half (?:of the table )?"
     rf"(?:back|free|empty|clear|for something else)", _frees),
    (rf"(?:that |which |it |is |the |tip |apex |should )*(?:points?|pointed|pointing|facing|faces) "
     rf"(?:to(?:wards?)? |at )?(?:the )?(?P<place>{SIDE}|up|down|upwards?|downwards?)", _points),
    (r"(?:that |which )?(?:meet|meets|meeting|touch|touching) (?:in|across|along|at|over) (?:the|its) (?:middle|centre)"
     r"(?: of (?:a|the) window)?", _gate),
    (r"from (?:above and (?:from )?below|(?:the )?top and (?:the )?bottom|both ends)", _full_width),
    (r"(?:the |its )?(?:collar|neck|print|logo|front) (?:on top|facing up|visible|showing|up)", _nothing),
    (r"(?:all )?(?:four |the )*(?:points|corners|tips) (?:meet|meeting|meet up|touching)(?: in the (?:middle|centre))?",
     _nothing),
    (r"(?:leave |keep )?(?:all )?the (?:rest|others?) (?:as (?:it is|they are)|untouched|alone)", _nothing),
    (r"(?:and )?(?:nothing else|no other fold)|the sleeves (?:may|can) stick out|as if (?:it|they) had", _nothing),
    (r"i do not (?:mind|care) (?:how|which|where)|(?:no|does not|do not|never) (?:matter|mind) how", _nothing),
]  # fmt: skip
"""Patterns of sizes, counts, vanishing parts, places and directions; the longest match counts."""
