"""Numbers as people say them: shares in one form, and of a number that is corrected the last."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from polyfold_offline.meaning.program import FRACTIONS

UNITS = r"(?:mm|mill?imet(?:er|re)s?|cms?|centimet(?:er|re)s?|inch(?:es)?|m\b|met(?:er|re)s?)"
"""Pattern of a unit of length."""

_TEENS = """zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen
seventeen eighteen nineteen"""
_TENS = {"twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90}
_NUMBERS = {word: number for number, word in enumerate(_TEENS.split())} | _TENS

AMOUNT = (
    rf"(?<![\w.,/])(?:\d+(?:[.,]\d+)?|(?:(?:{'|'.join(_TENS)})[ -])?"
    rf"(?:{'|'.join(_NUMBERS)})(?:\s+and\s+a\s+half)?)"
)
"""Pattern of a number, in figures or in words."""

_DENOMINATORS = {
    "seventh": 7, "ninth": 9, "tenth": 10, "eleventh": 11, "twelfth": 12, "sixteenth": 16, "twentieth": 20,
}  # fmt: skip
_COUNTS = {
    "a": 1, "an": 1, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9,
}  # fmt: skip
_NO_SHARE = r"(?!\s+(?:time|fold|step|edge|side|corner|layer))"

_SHARE = re.compile(
    r"(?<![\w.,/])(?:"
    r"(?P<decimal>0?[.,]\d+)(?!\s*(?:mm|cm|m\b|inch|milli|centi|met))(?![\w.,/])"
    r"|(?P<percent>\d+(?:[.,]\d+)?)\s*(?:%|per\s?cent\b)"
    r"|(?P<over>\d{1,2})/(?P<under>\d{1,2})(?![\w/])"
    rf"|(?P<count>{'|'.join(_COUNTS)})[ -](?P<part>{'|'.join(_DENOMINATORS)})s?\b{_NO_SHARE}"
    r")",
    re.IGNORECASE,
)

_CORRECTING = (
    r"no|nope|sorry|oops|e+r+m?|u+[hm]+|ehm|hmm?|wait|actually|rather|or rather|i mean|i meant|make (?:that|it)|better"
    r"|correction|(?:scratch|strike) that|my mistake|not that|let's say|(?:that|it) should (?:be|have been)"
)
_APART = r"[\s,.;:!…–—-]"
_NUMBER_ENDS = r"(?=(?:\s+(?:of it|deep|wide|high|tall))?(?:\s*(?:[,.;:!?…]|$)|\s+(?:instead|rather|please)\b))"


_WRONG = rf"{AMOUNT}\s*-?\s*(?P<unit>{UNITS})(?!\w)(?P<between>[^;!?#\d]{{0,40}}?){_APART}+"
_RIGHT = rf"(?P<last>{AMOUNT})(?:\s*-?\s*(?P<other>{UNITS})(?!\w))?"
_CORRECTED = tuple(
    re.compile(_WRONG + right, re.IGNORECASE)
    for right in (
        rf"(?:(?:{_CORRECTING}|not {AMOUNT}(?:\s*{UNITS})?)(?!\w){_APART}*)+{_RIGHT}{_NUMBER_ENDS}",
        rf"{_RIGHT},?\s+i (?:mean|meant)(?: to say)?\b",
    )
)


def number_of(words: str) -> float:
    """The number that :data:`AMOUNT` matched."""
    words = words.lower().replace(",", ".")
    half = 0.5 if "half" in words else 0.0
    words = re.sub(r"\s+and\s+a\s+half", "", words)
    try:
        return float(words)
    except ValueError:
        return sum(_NUMBERS[word] for word in re.split(r"[ -]+", words)) + half


def with_last_numbers(text: str) -> str:
    """A length that is corrected, *5 cm on the left, no, make that 10*, with its last number alone."""
    for corrected in _CORRECTED:
        text = corrected.sub(lambda it: f"{it['last']} {it['other'] or it['unit']}{it['between']}", text)
    return text


def with_plain_shares(text: str, marked: Callable[[Fraction], str]) -> str:
    """Shares such as ``0.25``, ``20 %`` or ``2/10`` in the words that the reader knows, ``1/4``.

    Args:
        text: the sentence.
        marked: what to put in the place of those that it does not know, such as a tenth; called in their order.
    """

    def plain(match: re.Match[str]) -> str:
        share = _value(match)
        if share == 0 or (share >= 1 and not match["percent"]) or share == 1:
            return match[0]
        if share == Fraction(1, 2):
            return "half"
        return str(share) if str(share) in FRACTIONS else marked(share)

    return _SHARE.sub(plain, text)


def _value(match: re.Match[str]) -> Fraction:
    if match["decimal"]:
        return Fraction(match["decimal"].replace(",", "."))
    if match["percent"]:
        return Fraction(match["percent"].replace(",", ".")) / 100
    if match["over"]:
        return Fraction(int(match["over"]), int(match["under"])) if int(match["under"]) else Fraction(0)
    return Fraction(_COUNTS[match["count"].lower()], _DENOMINATORS[match["part"].lower()])
