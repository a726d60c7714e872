"""Numbers as people say them: shares in one form, and of a number that is corrected the last."""

from __future__ import annotations

import re
from fractions import Fraction

from polyfold_offline.meaning.program import FRACTIONS

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


def with_plain_shares(text: str, mark: str) -> tuple[str, list[Fraction]]:
    """Shares such as ``0.25``, ``20 %`` or ``2/10`` in the words that the reader knows, ``1/4``.

    Those that it does not know, such as a tenth, become ``mark`` and are returned, in their order.
    """
    unknown: list[Fraction] = []

    def plain(match: re.Match[str]) -> str:
        share = _value(match)
        if share == 0 or (share >= 1 and not match["percent"]) or share == 1:
            return match[0]
        if share == Fraction(1, 2):
            return "half"
        if str(share) in FRACTIONS:
            return str(share)
        unknown.append(share)
        return mark

    return _SHARE.sub(plain, text), unknown


def _value(match: re.Match[str]) -> Fraction:
    if match["decimal"]:
        return Fraction(match["decimal"].replace(",", "."))
    if match["percent"]:
        return Fraction(match["percent"].replace(",", ".")) / 100
    if match["over"]:
        return Fraction(int(match["over"]), int(match["under"])) if int(match["under"]) else Fraction(0)
    return Fraction(_COUNTS[match["count"].lower()], _DENOMINATORS[match["part"].lower()])


def with_last_numbers(text: str, amount: str, unit: str) -> str:
    """A length that is corrected, *5 cm on the left, no, make that 10*, with its last number alone.

    Args:
        text: the sentence.
        amount, unit: patterns of a number and of a unit of length.
    """
    wrong = rf"{amount}\s*-?\s*(?P<unit>{unit})(?!\w)(?P<between>[^;!?#\d]{{0,40}}?)"
    right = rf"(?P<last>{amount})(?:\s*-?\s*(?P<other>{unit})(?!\w))?"
    before = rf"{_APART}+(?:(?:{_CORRECTING}|not {amount}(?:\s*{unit})?)(?!\w){_APART}*)+{right}{_NUMBER_ENDS}"
    after = rf"{_APART}+{right},?\s+i (?:mean|meant)(?: to say)?\b".replace("<last>", "<last2>").replace(
        "other", "other2"
    )
    corrected = re.compile(f"{wrong}(?:{before}|{after})", re.IGNORECASE)

    def last(found: re.Match[str]) -> str:
        number, own = found["last"] or found["last2"], found["other"] or found["other2"]
        return f"{number} {own or found['unit']}{found['between']}"

    return corrected.sub(last, text)
