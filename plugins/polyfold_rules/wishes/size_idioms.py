"""Sizes in turns of phrase that are read only once the grammar of folds has given up: comparisons, numbers of folds.

They may use words of folding (*fold it twice*) without taking a sentence from that grammar.
"""

from __future__ import annotations

import re

from polyfold_rules.wishes.readers import Reader, stacked
from polyfold_rules.wishes.sizes import (
    CLOTH,
    COUNTS,
    DIM,
    FRACTION,
    FRACTIONS,
    OF,
    QUANTITY,
    A,
    about,
    at_most,
    halved,
    is_share,
)
from polyfold_rules.wishes.wish import Bound, Wish

LESS = {
    "area": "smaller littler tinier",
    "width": "narrower slimmer thinner skinnier",
    "height": "lower flatter",
    "length": "shorter",
}
LESSER = {word: name for name, words in LESS.items() for word in words.split()}
MUCH = r"(?P<much>a lot |lots |much |way |far |considerably |significantly |clearly |a good deal |quite a bit )?"
SLIGHT = r"(?P<slight>a bit |a little(?: bit)? |slightly |somewhat |a touch |a tad |a shade |just a bit |some )?"
IT = r"(?:it|them|this|these|that|those|(?:the|my|our|his|her|your) \w+)"
WANT = r"(?:want|need|like|wish|would like|have|care for)"
TIMES = rf"(?P<times>once|twice|thrice|(?:\d+|{'|'.join(COUNTS)}) (?:times|x))"
PALM = (
    r"(?:smart ?phone|phone|mobile|palm|hand|wallet|playing card|credit card|bar of soap|soap|passport|coaster"
    r"|cup|mug"
    r"|fist|matchbox|deck of cards|beer mat|saucer|purse|post ?card|cd|sandwich)"
)
BOOKISH = (
    r"(?:book|paperback|magazine|laptop|tablet|pillow|shoe ?box|sheet of paper|piece of paper|page|a4(?: sheet"
    r"| page)?"
    r"|folder|dinner plate|plate|pizza box|brick|newspaper|cushion|lunch ?box)"
)


def _lesser(quantity: str, match: re.Match[str]) -> Bound:
    """Less of a quantity, without a measure: about half, and a quarter off if it is to be slight."""
    said = match.groupdict()
    if said.get("slight"):
        return Bound(quantity, 0.55, 0.93, 0.75)
    return Bound(quantity, 0.1, 0.56, 0.5) if said.get("much") else Bound(quantity, 0.3, 0.85, 0.5)


def _less(wish: Wish, match: re.Match[str]) -> None:
    quantity = LESSER[match.group("less")]
    if quantity == "area" and not match.group("slight"):
        wish.small = True
    else:
        wish.bounds.append(_lesser(quantity, match))


def _not_so(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(_lesser(QUANTITY[match.group("dim")], match))


def _not_so_big(wish: Wish, match: re.Match[str]) -> None:
    wish.small = True


def _short(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("length", 0.3, 0.85, 0.5))


def _count(said: str) -> int:
    number = said.split()[0]
    return {"once": 1, "twice": 2, "thrice": 3}.get(number) or (int(number) if number.isdigit() else COUNTS[number])


def _times_less(wish: Wish, match: re.Match[str]) -> None:
    quantity = QUANTITY.get(match.groupdict().get("dim") or "", "area")
    wish.bounds.append(about(quantity, 1 / max(_count(match.group("times")), 1)))


def _folded_times(wish: Wish, match: re.Match[str]) -> None:
    times = _count(match.group("times"))
    loose = re.search(r"most|more|up to|max", match.group(0))
    wish.steps = (1 if loose else times, times)


def _more_than_once(wish: Wish, match: re.Match[str]) -> None:
    wish.steps = (2, 9)


def _parts_of(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", FRACTIONS[{"halves": "half"}.get(match.group("part"), match.group("part")[:-1])]))


def _equal_parts(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", 1 / max(_count(match.group("times")), 1)))


def _doubled(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", 1 / 2))


def _proportioned(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("rectangle")
    wish.bounds.append(about("slim", 1 / max(_count(match.group("times")), 1)))


def _even_sided(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("square")


def _hand_sized(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("pocket")


def _smallest(wish: Wish, match: re.Match[str]) -> None:
    wish.small = wish.least = True


SIZE_IDIOMS: list[tuple[str, Reader]] = [
    (rf"^(?:just |only |to |by |about )*{FRACTION}(?: size| the size)?(?=(?:,? please)?[ .!?]*$)", is_share),
    (rf"(?:cut|cutting|bring|brought|chop|divide|slash)(?: down)? {OF}{DIM} (?:down )?(?:in|by|into) (?:half|two)",
     halved),
    (r"not (?:take up|takes up|fill|cover|occupy|need|use|hog|clutter)(?: up)? (?:(?:the|an|so|my|our|your|as"
     r"|too|that|a) )*"
     r"(?:entire|whole|full|all of|all|much|half)(?: of)?(?: (?:the|my|our))?(?: \w+)?", _not_so_big),
    (rf"{MUCH}{SLIGHT}(?P<less>{'|'.join(LESSER)})(?: than (?:before|now|it (?:is|was)|they (?:are|were)|that|this)"
     r"(?: now)?)?", _less),
    (rf"{MUCH}{SLIGHT}less (?P<dim>wide|broad|high|tall|long)", _not_so),
    (r"(?:much |a lot |far )?less (?:big|large|bulky|space|room)", _not_so_big),
    (r"(?:not|never|no)(?: be)? (?:(?:quite )?(?:so|as|that|too)|very) (?P<dim>wide|broad|high|tall|long)", _not_so),
    (r"(?:not|never|no)(?: be)? (?:(?:quite )?(?:so|as|that|too)|very) (?:big|large|bulky|huge|much (?:space|room))",
     _not_so_big),
    (rf"(?P<much>far |way |much )?{SLIGHT}too (?P<dim>wide|broad|high|tall|long)(?: (?:for|as) (?:it"
     rf"|they) (?:is|are))?",
     _not_so),
    (r"(?:far |way |much |a bit |a little |slightly )?too (?:big|large|bulky|huge|much (?:space|room))", _not_so_big),
    (r"(?:short(?:en(?:ed)?)?|low)(?: in length)?", _short),
    (rf"{TIMES} (?:as (?=small|narrow|short|compact|slim)|less )(?P<dim>small|narrow|short|compact|slim|long"
     rf"|wide|big|large)"
     r"(?: as (?:before|now|it (?:is|was)|they (?:are|were)))?", _times_less),
    (rf"(?:by )?a factor of (?P<times>\d+|{'|'.join(COUNTS)})", _times_less),
    (r"(?:in|into|to) (?P<part>halves|thirds|quarters|fourths|fifths|sixths|eighths|ninths|sixteenths)", _parts_of),
    (rf"(?:in|into|of) (?P<times>\d+|{'|'.join(COUNTS)})(?: (?:equal|even|same sized|identical|equally large))?"
     r"(?: (?:parts?|pieces|portions|sections|fields))?(?= ?[.,;!?]|$)", _equal_parts),
    (rf"(?:fold(?:ed|ing)? (?:{IT} )?(?:up |over )?|not (?:want to )?fold {IT} )?(?:only |just |exactly |precisely |"
     rf"more than |at most |no more than |not more than |up to |maximum )*{TIMES}(?! more| again)(?: (?:over|only"
     rf"|at (?:the )?most|max|"
     r"folded))?", _folded_times),
    (r"(?:smaller )?(?:one )?than (?:(?:you|one|we|i) (?:get|have|has|make|would get|gets) )?(?:in|with|after"
     r"|by|from) "
     r"(?:only |just |a |one |single )*fold(?:ing)?(?: once)?", _more_than_once),
    (r"more than (?:once|one fold|a single fold)|several (?:times|folds)|a (?:few|couple of) (?:times|folds)",
     _more_than_once),
    (rf"not (?:{WANT} )?(?:{IT} )?(?:to )?(?:be |get |cover |take up |show |see |occupy )?(?:any )?"
     rf"(?:more|larger|bigger|wider|longer|higher|taller) than {A}{FRACTION}(?: of)?(?: ?{OF}{DIM})?"
     rf"(?: ?{OF}{CLOTH})?", at_most),
    (rf"(?:cover|covers|covering|fill|fills|take up|takes up|occupy|occupies|use|uses)(?: only| just| about)* "
     rf"{A}{FRACTION}(?: of)?(?: (?:the|my|our|its|a) (?:table|bed|tray|sofa|couch|bench|window|box|basket"
     rf"|mattress|shelf|drawer|counter|space|room|place"
     rf"|worktop|desk)"
     r"(?: top| it (?:does|has|takes)(?: now)?)?)?", is_share),
    (rf"{A}{FRACTION} of (?:its|their|the) (?:{OF})?{DIM}(?: {CLOTH})?", is_share),
    (r"(?:folded )?(?:double|doubled)(?: over| up| layered)?|two ply|in two", _doubled),
    (rf"{TIMES} as (?:long|tall|high|wide|broad) as (?:it is |they are )?(?:wide|broad|high|tall|long|deep)",
     _proportioned),
    (r"as (?:wide|broad|long|high|tall) as (?:it is )?(?:wide|broad|long|high|tall)|(?:all (?:four )?)?(?:its |the )?"
     r"sides (?:are |should be |all )*(?:equal|equally long|the same|the same length|of equal length)|equal sides|"
     r"equal sided", _even_sided),
    (rf"(?:about |roughly |around |no (?:bigger|larger) than |not (?:bigger|larger) than |smaller than "
     rf"|as (?:small|big|"
     rf"large) as |(?:the |of )*size of |into )+(?:a |an |my |your |his |her |the )(?:\w+ )?{PALM}|(?:{PALM}"
     rf"|pocket|palm|"
     r"hand|wallet) sized?", _hand_sized),
    (rf"(?:about |roughly |around |no (?:bigger|larger) than |not (?:bigger|larger) than |smaller than "
     rf"|as (?:small|big|"
     rf"large) as |(?:the |of )*size of )+(?:a |an |my |your |his |her |the )(?:\w+ )?{BOOKISH}|{BOOKISH} sized?",
     stacked),
    (r"(?:as|the) (?:small|tiny|compact|little|dense|tight)(?:est|ly)?(?: and \w+)? (?:as"
     r"|that)? ?(?:ever )?(?:you can|"
     r"can be|possible|it (?:gets|goes|can be|will go)|they (?:get|go|can be|will go)|you (?:get|manage|are able to))"
     r"(?: (?:make it|make them|get it|get them|manage|go|be))?|(?:maximally|extremely|super|ultra) (?:small"
     r"|compact)",
     _smallest),
]  # fmt: skip
