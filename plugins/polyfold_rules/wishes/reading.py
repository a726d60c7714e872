"""What an instruction wants the end to be, if it leaves the folds open: sizes, shapes, purposes, parts that vanish.

A wish is read only if every word is accounted for: what is neither part of a wish nor a word without meaning here may
stand only as an adjunct (*for the shelf in the bathroom*). Anything else is left to the grammar of folds, or refused.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

from polyfold_rules.wishes.manners import ASIDES, MANNERS
from polyfold_rules.wishes.part_idioms import PART_IDIOMS
from polyfold_rules.wishes.parts import PARTS
from polyfold_rules.wishes.readers import Reader
from polyfold_rules.wishes.size_idioms import SIZE_IDIOMS
from polyfold_rules.wishes.sizes import SIZES
from polyfold_rules.wishes.wish import Wish
from polyfold_rules.words.lexicon import fillers, phrases
from polyfold_rules.words.spelling import NUMBERS, plainest

LIKE = r"(?:like|into|become|becomes|as|resemble|resembles) (?:a |an |a pair of )?"


def read_wish(text: str, garment_words: frozenset[str], folds_named: bool = False) -> Wish | None:
    """The wish in an instruction, or None if it is not one, or not only.

    Args:
        text: the instruction.
        garment_words: values of the lexicon's garments that mean the one on the table.
        folds_named: allow *fold* as a verb: *fold it so that it fits in a drawer*.
    """
    words = plainest(text)
    if _CARRIES.search(_OWN_PLAN.sub("i ", words) if folds_named else words):
        return None
    wish = Wish()
    places = _TIMES if "fold" in words else _PLACES | _TIMES if folds_named else _PLACES
    at, adjunct, told = 0, False, 0
    while at < len(words):
        told = max(told, _circumstance(words, at) if folds_named else 0)
        found = _rule_at(words, at, folds_named)
        if found is not None:
            rule, match = found
            rule(wish, match)
            wish.words.append(match.group(0).strip())
            at, adjunct = match.end(), False
            continue
        aside = _aside(words, at, garment_words) if folds_named else None
        if aside is not None:
            wish.passed += [said for said in aside.group(0).split() if said not in _vocabulary()["filler"]]
            at, adjunct = aside.end(), False
            continue
        word = _WORD.match(words, at)
        if word is None:
            adjunct = adjunct and words[at] == " "
            at += 1
            continue
        said = word.group(0)
        if said in _ADJUNCTS or said in places:
            adjunct = True
        elif said in _vocabulary()["filler"] or (said == "fold" and folds_named):
            pass
        elif (name := _named(words, at, garment_words) if folds_named else 0) > word.end():
            at, adjunct = name, False
            continue
        elif said in garment_words or _names(said, garment_words):
            adjunct = False
        elif (adjunct and not _means_something(said)) or (at < told and _tells_nothing(said)):
            wish.passed.append(said)
        else:
            return None
        at = word.end()
    return wish if wish.says_something else None


_CARRIES = re.compile(
    r"(?:^|[.,;:] |please |and |then |you |to )(?:hang|put|place|lay|throw|carry|bring|drop|stuff|toss|stick"
    r"|pop|drape"
    r"|take|pack|store|stow|move|send) (?:up |away )?(?:(?:the|this|that|these|those|my|your|it|them|a|two)\b ?)"
    r"(?:(?:\w+ )?\w+ )?(?:up|away|back|down|in|into|on|onto|over|to|inside|around)\b(?! (?:shape|form|order|half))"
)
"""The cloth is to be brought somewhere: *hang the shirt up*, *put it in the drawer*."""

_OWN_PLAN = re.compile(
    r"\b(?:i|we|she|he|they)(?: (?:just|really|usually|always|also|will|would|can|could|may|might|have|am|are))*"
    r"(?: (?:need|needs|want|wants|like|have|has|got|going|plan|planning|about|love|prefer) to)?"
    r" (?=(?:hang|put|place|lay|throw|carry|bring|drop|stuff|toss|stick|pop|drape|take|pack|store|stow|move|send)\b)"
)
"""What people mean to do with the cloth themselves: *I want to hang it over the rail*."""

_WORD = re.compile(r"[a-z0-9']+")
_ADJUNCTS = frozenset(["for", "in", "of", "at", "before", "after", "next", "near", "from", "inside", "with"])
_PLACES = frozenset(["on", "over", "under", "beside"])
"""Words that begin an adjunct, in which unknown nouns tell nothing about the shape; nothing is folded at a place."""


_TIMES = frozenset(["while", "until", "when", "during"])

_REMARK = re.compile(r"[a-z0-9', ]+(?=[.!?:;])")
_SUBJECT = re.compile(
    r"(?:my|our|his|her|your|an?|the) [a-z0-9]+(?= (?:will|wants?|needs?|has|would|should|could|may)\b)"
)
_MODIFIER = re.compile(r"[a-z]+(?= )")
_MODIFIERS = re.compile(r"[a-z]+ [a-z]+(?= )")
_LIKENESS = frozenset([
    "into", "like", "as", "make", "turn", "become", "becomes", "shape", "form", "resemble", "resembles", "not", "no",
    "never", "without",
])  # fmt: skip


_WHEREABOUTS = (
    _PLACES | _TIMES | frozenset(["up", "down", "back", "again", "away", "around", "next", "not", "no", "never"])
)
_CLAUSE = re.compile(
    r"(?:(?:and|but|so|because|since|as|after all|when|while|before|after|until|once|for when|in case|well|oh"
    r"|sorry) )*"
    r"(?:i|we|he|she|they|it|there|someone|somebody|everyone|everybody|guests?|(?:my|our|his|her|your|the|a|an"
    r"|this|that|these"
    r"|those|all|some) (?!first|next)[a-z]+)"
    r"(?: (?!so |but |because |since )[a-z0-9']+)+"
)
_REQUEST = re.compile(
    r"\b(?:(?:wants?|needs?|like|love|have|has|going|got)(?= (?:it|them|this|these|to (?:be|look|get|become"
    r"|have|see|make"
    r"|resemble|fold|turn|lie|end|point|cover)\b))|would|should|must|ought|make|turn|fold|folded|folding|look"
    r"|looks|becomes?|please|can"
    r"|could|shaped?|form|into|(?<!would )like(?! to)|resembles?|wish|wants?(?! to)|needs?(?! to| \w+ing))\b"
)
_DENIAL = re.compile(r"\b(?:not|no|never|without)\b")


def _tells_nothing(said: str) -> bool:
    """Whether a word of a circumstance makes no difference to the end."""
    return said in _WHEREABOUTS or said.endswith("ing") or not _means_something(said)


def _circumstance(words: str, at: int) -> int:
    """Where a clause ends that tells why or when something is wished (*my suitcase is almost full*); 0 if none begins.

    Its unknown words tell nothing about the end. A clause that asks for something is none, and neither is one that
    denies something a wish could hold.
    """
    if (at and words[at - 1].isalnum()) or (
        at and not re.search(r"(?:[.,!?:;]|\bso|\bbut|\bbecause|\bsince) ?$", words[:at])
    ):
        return 0
    clause = _CLAUSE.match(words, at)
    if clause is None or _REQUEST.search(clause.group(0)):
        return 0
    denied = _DENIAL.search(clause.group(0))
    if denied and any(_rule_at(words, i, True) for i in range(at, clause.end())):
        return 0
    return clause.end()


def _aside(words: str, at: int, garment_words: frozenset[str]) -> re.Match[str] | None:
    """Words that tell nothing about the end: a remark of its own, who wishes, what kind of garment or place it is."""
    if at and words[at - 1].isalnum():
        return None
    if not at or words[:at].rstrip()[-1:] in ".!?:;":
        remark = _REMARK.match(words, at)
        if remark and _idle(remark.group(0)) and not any(_rule_at(words, i, True) for i in range(at, remark.end())):
            return remark
    subject = _SUBJECT.match(words, at)
    if subject and _idle(subject.group(0)):
        return subject
    for pattern in (_MODIFIER, _MODIFIERS):
        modifier = pattern.match(words, at)
        if modifier and _modifies(words, modifier, garment_words):
            return modifier
    return None


def _modifies(words: str, modifier: re.Match[str], garment_words: frozenset[str]) -> bool:
    """Whether the word after is a name of the garment, or something that is wished."""
    at, end = modifier.start(), modifier.end() + 1
    if not _idle(modifier.group(0)) or not _vocabulary()["filler"].isdisjoint(modifier.group(0).split()):
        return False
    likened = re.search(r"(?:into|like|as) (?:an? )?$", words[:at]) is not None
    following = _WORD.match(words, end)
    named = following is not None and not likened and _names(following.group(0), garment_words)
    return named or _rule_at(words, end, True) is not None


def _idle(said: str) -> bool:
    return not any(word in _LIKENESS or word in NUMBERS or _means_something(word) for word in _WORD.findall(said))


def _names(word: str, garment_words: frozenset[str]) -> bool:
    entries = phrases().get(word, phrases().get(word.removesuffix("s"), ()))
    return any(category == "garment" and value in garment_words and len(said) == 1 for said, category, value in entries)


def _named(words: str, at: int, garment_words: frozenset[str]) -> int:
    """Where a name of the garment in several words ends (*bath mat*); 0 if none stands here."""
    first = words[at:].partition(" ")[0]
    for said, category, value in phrases().get(first, ()):
        name = " ".join(said)
        if category == "garment" and value in garment_words and re.match(rf"{name}(?:e?s)?\b", words[at:]):
            return at + len(name)
    return 0


def _means_something(word: str) -> bool:
    """Whether the grammar of folds knows a word, other than as one without meaning."""
    entries = [*phrases().get(word, ()), *phrases().get(word.removesuffix("s"), ())]
    known = any(len(said) == 1 and category != "garment" for said, category, _ in entries)
    return known and word not in fillers()


@cache
def _vocabulary() -> dict[str, frozenset[str]]:
    table, _, filler = files("polyfold_rules.wishes").joinpath("wishes.txt").read_text("utf-8").partition("\nfiller:\n")
    words: dict[str, frozenset[str]] = {"filler": frozenset(filler.split())}
    for line in table.splitlines():
        head, _, rest = line.partition(":")
        if rest and not line.startswith("#"):
            words[head] = frozenset(phrase.strip() for phrase in rest.split(","))
    return words


def _rule_at(words: str, at: int, folds_named: bool = False) -> tuple[Reader, re.Match[str]] | None:
    """The rule that takes the most words here; ``folds_named`` as for :func:`read_wish`."""
    if at and words[at - 1].isalnum():
        return None
    found = [(rule, match) for pattern, rule in _rules(folds_named) if (match := pattern.match(words, at)) is not None]
    return max(found, key=lambda pair: pair[1].end(), default=None)


@cache
def _rules(folds_named: bool) -> list[tuple[re.Pattern[str], Reader]]:
    idioms = SIZE_IDIOMS + PART_IDIOMS + MANNERS + ASIDES if folds_named else []
    patterns = idioms + SIZES + PARTS
    known = [(_any_of(head, words), _known(*head.split())) for head, words in _vocabulary().items() if head != "filler"]
    return known + [(re.compile(pattern + r"\b"), rule) for pattern, rule in patterns]


_BEFORE = {
    "worn": rf"(?:{LIKE}|(?<!fold )(?<!folding )an? )",
    "look boat": r"(?:an? |like |into |resembles? )(?:an? |the )?(?:\w+ )?",
    "look gate": r"(?:two |a pair of )?",
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
