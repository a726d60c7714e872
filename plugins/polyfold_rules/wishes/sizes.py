"""What a wish says of sizes, layers and numbers of folds: patterns, and what each means."""

from __future__ import annotations

import re

from polyfold_rules.wishes.readers import Reader
from polyfold_rules.wishes.wish import Bound, Wish
from polyfold_rules.words.spelling import NUMBERS

FRACTIONS = {
    "half": 1 / 2, "third": 1 / 3, "quarter": 1 / 4, "fourth": 1 / 4, "fifth": 1 / 5, "sixth": 1 / 6, "eighth": 1 / 8,
    "ninth": 1 / 9, "tenth": 1 / 10, "twelfth": 1 / 12, "sixteenth": 1 / 16,
    "two thirds": 2 / 3, "three quarters": 3 / 4,
}  # fmt: skip
QUANTITIES = {
    "area": "size sizes area footprint ground floor surface space room big bigger large larger small smaller compact",
    "width": "width wide wider narrow narrower broad broader breadth slim slimmer",
    "height": "height high higher tall taller",
    "length": "length long longer short shorter",
}
QUANTITY = {word: name for name, words in QUANTITIES.items() for word in words.split()}

A = r"(?:a |an |one |its |their |just |only |about |roughly |around |to |by |down |the )*"
FRACTION = rf"(?P<share>{'|'.join(sorted(FRACTIONS, key=len, reverse=True))}|\d\d percent)"
NOUN = r"(?P<dim>size|ground|floor|sizes|area|footprint|surface|space|room|width|breadth|height|length)"
DIM = rf"(?P<dim>{'|'.join(QUANTITY)})"
OF = r"(?:of |in |the |its |their |it |his |her |original |present |current |full |flat |whole |own |total )*"
CLOTH = (
    r"(?:(?:what )?(?:it|they) (?:is|are|was|were|covers?|measures?|takes? up|occup(?:y|ies))(?: now| at present)?"
    r"|(?:these|them|those)\b|(?:cloth|towel|napkin|shirt|tee|tshirt|pants|trousers|jeans"
    r"|garment|fabric|square|rectangle|sheet|thing)\b)"
)
COUNTS = {**NUMBERS, "twelve": 12, "sixteen": 16, "double": 2, "single": 1, "both": 2}
NUMBER = rf"(?P<number>\d+|{'|'.join(COUNTS)})"
STEP = r"(?:steps?|folds?|moves?|stages?|goes|foldings?|movements?)"

TOLERANCE = 1.25
"""A size that is asked for may be missed by this factor: nobody measures a quarter."""


def _share(match: re.Match[str]) -> float:
    said = match.group("share")
    return int(said[:2]) / 100 if said[0].isdigit() else FRACTIONS[said]


def _quantity(match: re.Match[str]) -> str:
    return QUANTITY.get(match.groupdict().get("dim") or "", "area")


def about(quantity: str, value: float) -> Bound:
    """A size that is asked for, and what passes for it."""
    return Bound(quantity, value / TOLERANCE, value * TOLERANCE, value)


def is_share(wish: Wish, match: re.Match[str]) -> None:
    """A size that is a share of what it was."""
    wish.bounds.append(about(_quantity(match), _share(match)))


def _less_by(wish: Wish, match: re.Match[str]) -> None:
    share = 1 - _share(match)
    wish.bounds.append(Bound(_quantity(match), share / 1.15, share * 1.15, share))


def at_most(wish: Wish, match: re.Match[str]) -> None:
    """A size that must not be more than a share of what it was."""
    wish.bounds.append(Bound(_quantity(match), high=_share(match) * 1.15))


def _below(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound(_quantity(match), high=_share(match) * 0.97))


def halved(wish: Wish, match: re.Match[str]) -> None:
    """Half of a size."""
    wish.bounds.append(about(_quantity(match), 1 / 2))


def _times_smaller(wish: Wish, match: re.Match[str]) -> None:
    number = _number(match)
    wish.bounds.append(about(_quantity(match), 1 / max(number, 1)))


def _unchanged(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound(_quantity(match), low=0.95))


def _one_leg_wide(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("width", high=0.6))


def _number(match: re.Match[str]) -> int:
    said = match.group("number")
    return int(said) if said.isdigit() else COUNTS[said]


def _steps(wish: Wish, match: re.Match[str]) -> None:
    number = _number(match)
    loose = re.search(
        r"most|tops|more than|up to|will do|enough|allow|max|maximum|fewer|or less|or two", match.group(0)
    )
    wish.steps = (1, number) if loose else (number, number)


def _as_small_as_steps_allow(wish: Wish, match: re.Match[str]) -> None:
    wish.least, wish.steps = True, (1, _number(match))


def _full_width(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("width", low=0.95))


def _layers(wish: Wish, match: re.Match[str]) -> None:
    """Layers lie on an equal share of the flat cloth each."""
    wish.bounds.append(about("area", 1 / max(_number(match), 1)))


def _halved_often(wish: Wish, match: re.Match[str]) -> None:
    times = 3 if match.group("often").startswith("three") else 2
    wish.bounds.append(about(_quantity(match), 1 / 2**times))
    wish.steps = (times, times)


def _both_are(wish: Wish, match: re.Match[str]) -> None:
    share = _share(match) if match.group("share") else 1 / 2
    wish.bounds += [about(QUANTITY[match.group(name)], share) for name in ("dim", "also")]


def _both_at_most(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds += [Bound(QUANTITY[match.group(name)], high=_share(match) * 1.15) for name in ("dim", "also")]


SIZES: list[tuple[str, Reader]] = [
    (rf"(?:in |with |using |within |by |take |takes )?(?:at most |no more than |not more than |up to |only |just "
     rf"|exactly |as few as |max |maximum |precisely |a )*{NUMBER}(?: simple| diagonal)? {STEP}(?: at (?:most|the "
     rf"most)| or less"
     rf"| or fewer| tops| exactly| will do| is enough| are enough| is plenty| allow| max| maximum)?", _steps),
    (rf"as small as {NUMBER} {STEP} allow", _as_small_as_steps_allow),
    (rf"{A}{FRACTION}(?: of)?(?: {OF})?(?: ?{DIM})(?: (?:at (?:the )?most|or less|maximum|max))", at_most),
    (rf"{A}{FRACTION} ?{OF}{NOUN}(?: left| as before| of (?:before|now|{CLOTH}))?", is_share),
    (rf"{A}{FRACTION} as {DIM}(?: as (?:before|now|it (?:is|was)|they (?:are|were))(?: now)?)?", is_share),
    (rf"{A}{FRACTION} of (?:the |its |their )?{CLOTH}", is_share),
    (rf"(?:down to|to|about|by|is|covers?|only|just) (?:a |an |one )?{FRACTION}(?! of| too| \w+er)", is_share),
    (rf"{A}{FRACTION} too {DIM}", _less_by),
    (rf"{A}{FRACTION} (?P<dim>\w+er)(?: than (?:before|now|it is|they are))?", _less_by),
    (rf"(?:no|not|never)(?: be)?(?: any)? {DIM} than {A}{FRACTION}(?: of {CLOTH})?", at_most),
    (rf"(?:no more|not more) than {A}{FRACTION}(?: ?{OF}{DIM})?(?: of (?:the |its |their )?{CLOTH})?", at_most),
    (rf"at most {A}{FRACTION}(?: ?{OF}{DIM})?(?: of (?:the |its |their )?{CLOTH})?", at_most),
    (rf"(?:less|smaller|shorter|narrower|lower) than {A}{FRACTION}(?: ?{OF}{DIM})?(?: of {CLOTH})?", _below),
    (rf"(?:halve|halving|halved) {OF}{DIM}", halved),
    (rf"{OF}{DIM} (?:is |are |be |to be )?halved", halved),
    (rf"{NUMBER} times {DIM}", _times_smaller),
    (rf"(?:the )?(?:full|whole|entire|same|all (?:of )?(?:the|its)) {DIM}(?: as (?:before|now))?", _unchanged),
    (rf"as {DIM} as (?:before|now|it (?:is|was)|they (?:are|were)|ever)(?: now)?", _unchanged),
    (r"(?:no (?:wider|broader) than |as (?:wide|narrow|broad) as )?(?:one|a single) leg(?: wide)?", _one_leg_wide),
    (r"from (?:above and (?:from )?below|(?:the )?top and (?:the )?bottom|both ends)", _full_width),
    (rf"(?:with |in )?{NUMBER} (?:layers?|pl(?:y|ies)|thicknesses)(?: of (?:cloth|fabric|denim|cotton|material))?"
     r"(?: thick| deep| everywhere| all over)*(?: instead of (?:one|a single(?: one)?))?", _layers),
    (rf"(?:(?:of|for) )?{NUMBER} (?:of (?:them|these|those) |tees |shirts |pairs |towels |napkins |cloths )?(?:to "
     rf"|can |will |should )*"
     r"(?:fit|fits|lie|go) (?:next to each other |side by side )?(?:where|in the (?:place|space) (?:of|where)) "
     r"(?:one|it|a single one)(?: lies| is)?(?: now)?", _times_smaller),
    (rf"(?:halve|halving|halved) (?:it |them |{OF}{DIM} )?(?P<often>twice|two times|three times)", _halved_often),
    (rf"{OF}{DIM} (?:and|as well as) {OF}(?P<also>{'|'.join(QUANTITY)}) (?:is |are |be |to be |should |must |both "
     rf"|each )*"
     rf"(?:halved|{FRACTION}(?: of (?:the |its |their )?{CLOTH})?)", _both_are),
    (rf"neither {OF}{DIM} nor {OF}(?P<also>{'|'.join(QUANTITY)}) (?:should |may |must |is to |be |exceeds? |more "
     rf"than "
     rf"|larger than )*{FRACTION}(?: of (?:the |its |their )?{CLOTH})?", _both_at_most),
    (rf"(?:must |should |may |can |shall )?not (?:\w+ |take up )(?:more than|over) {A}{FRACTION}(?: ?{OF}{DIM})?"
     rf"(?: of (?:the |its |their )?{CLOTH})?", at_most),
    (rf"(?:nothing |not |no )(?:larger|bigger|more|longer|wider) than {A}{FRACTION}(?: of (?:the |its |their )?"
     rf"{CLOTH})?",
     at_most),
    (rf"(?:under|below) {A}{FRACTION}(?: ?{OF}{DIM})?(?: of (?:the |its |their )?{CLOTH})?", _below),
    (rf"{A}{FRACTION} (?:less|fewer)(?: of the \w+)?", _less_by),
    (rf"{A}{FRACTION} (?:or (?:thereabouts|so|less)|at most)", is_share),
    (rf"(?<=: ){A}{FRACTION}(?=[.!?;,]|$)", is_share),
    (rf"{A}{FRACTION} ?{OF}{NOUN}(?: (?:that|which))?(?: of)? {CLOTH}", is_share),
    (rf"{A}{FRACTION} of (?:them|it|these) (?:showing|visible|left)", is_share),
    (rf"{OF}{DIM} (?:as (?:it )?is|kept|unchanged|preserved|untouched|(?:stays|remains)(?: as it is| the "
     rf"same)?)", _unchanged),
    (rf"{OF}{DIM} (?:ought to |should |must |has to |is |comes? |go |be |shrink |down |to |only |an? |one )+"
     rf"{FRACTION}", is_share),
    (rf"{A}{FRACTION} (?:of )?(?:the |its |their |my ){CLOTH} {NOUN}", is_share),
    (rf"every bit as {DIM}(?: as (?:before|now|it (?:is|was)))?", _unchanged),
]  # fmt: skip
"""Patterns of sizes and counts."""
