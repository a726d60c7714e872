"""Sentences put more plainly before they are read: abbreviations, courtesy, what was done already, lines of sleeves."""

from __future__ import annotations

import re

from polyfold_rules.words.geometric import without_geometry
from polyfold_rules.words.lexicon import phrases
from polyfold_rules.words.spelling import variants

_SHORT = {
    "tl": "top left", "tr": "top right", "bl": "bottom left", "br": "bottom right", "l": "left", "r": "right",
    "lh": "left", "rh": "right", "ctr": "centre", "1st": "first", "2nd": "then", "3rd": "then", "4th": "then",
    "btm": "bottom", "w/": "with",
}  # fmt: skip
_ABBREVIATED = re.compile(rf"(?<![\w'])(?:{'|'.join(_SHORT)})(?![\w'])")

_MIND = re.compile(
    r",? ?\bif (?:you do not|you don't|nobody|no one) minds?\b,?|\bif (?:that|it) is (?:ok|okay|all right)\b"
)
_IN_THE_END = re.compile(
    r"(?:^|(?<=[.;!?:] ))\s*(?:(?:once|when|after) (?:you (?:have|are)|it is|that is|everything is|all is) (?:all )?"
    r"(?:finished|done|through|ready)|at the end|in the end|as a result|when all is said and done)(?: of it)?,"
)
"""What is said before the result is told."""
_AS_BEFORE = re.compile(
    r",? (?:and|while|whereas|but|with) (?:the |all )[a-z ]+? (?:(?:is|are|stays?|remains?|lies?) )?"
    r"(?:exactly |just |left |right )?(?:as before|as it was|as they were|where it was|where they were|untouched)"
)
"""What stays where it is, told for the sake of completeness."""
_DONE = re.compile(
    r"\bwith (?P<part>(?:the|its|both|one|each) [^,;.]*?) (?P<verb>folded|brought|laid|placed|turned|tucked)"
    r" (?P<where>[^,;.]*?)(?: already)?, (?=(?:the|bring|fold|lay|put|take|tuck|turn|now)\b)"
)
"""*With the left half folded onto the right, bring the top down*: the first fold is told as a state."""

_LINE = (
    r"(?:, (?:fold|crease) (?=runs?|running|goes|going))?"
    r"(?:[,(:]? ?\b(?:along|about|at|on|over|by|with|around|following)\b )?"
    r"(?:\b(?:a|the|its|their|each|one|both|these|respective|straight|slanting|slanted|oblique|inward|imaginary) )*"
    r"(?:(?<=[a-z] )(?:lines?|creases?|segments?|folds?|seams?|diagonals?) )?"
    r"(?:\b(?:that|which|passes|running|runs|run|drawn|going|leading|joining|linking|connecting|of|passing|straight|"
    r"is|up) )*"
    r"(?:\b(?:from|between|through|via) )?(?:\bup )?"
)
_OWN = r"(?:\b(?:the|its|their|left|right|each|respective|side of the|end of the|top of the) )*"
_ARMPIT = r"(?:armpit|underarm|arm pit|under the arm)s?\b"
_UPPER = r"(?P<upper>shoulder|neckline|neck|collar)s?\b(?: (?:seam|line|point|opening))?"
_LINK = (
    r" ?(?:\b(?:straight|up|down|right|over|back|all the way)\b ?)*(?:\b(?:to|and|with|till)\b|>|-|,|\u2013|\u2014) ?"
)
_SLEEVE_LINES = (
    re.compile(_LINE + _OWN + _ARMPIT + _LINK + _OWN + _UPPER + r"(?: lines?\b)?\)?"),
    re.compile(_LINE + _OWN + _UPPER + _LINK + _OWN + _ARMPIT + r"(?: lines?\b)?\)?"),
)
"""The two lines along which sleeves are folded, however their ends are listed."""

_ALIGNED = re.compile(
    r"(?:, ?(?:and )?| and )(?P<part>(?:left|right|top|bottom|upper|lower)|[a-z]+ (?:corner|edge|end|side))"
    r" (?:on|onto|over|to) (?P=part)\b(?! (?:corner|edge|half|side|one|sleeve|leg))"
)
"""*Waistband corner on waistband corner*: how parts that are folded together lie anyway."""

_SPEAKERS = frozenset(["i", "we", "you", "me", "us", "it", "someone"])
_LEADS_TO_YOU = frozenset(["if", "whether", "that", "should", "could", "would", "can"])
_HELPERS = frozenset(["could", "would", "can", "might", "were", "to", "please", "just", "kindly"])
_MEANT = frozenset(["noun", "side", "garment", "verb", "neg", "except", "frac", "dir", "manner", "goal"])
"""Categories of words that belong to a fold, or deny one."""
_MAX_COURTESY = 12


def reworded(text: str) -> str:
    """The same instruction in plainer words; lower case is expected."""
    text = _ABBREVIATED.sub(lambda found: _SHORT[found.group(0)], text)
    text = without_geometry(_MIND.sub(" ", text))
    text = _AS_BEFORE.sub(" ", _IN_THE_END.sub(" ", text))
    text = _DONE.sub(lambda found: f"{found['verb']} {found['part']} {found['where']}, then ", text)
    text = _ALIGNED.sub(" ", text)
    for pattern in _SLEEVE_LINES:
        text = pattern.sub(_sleeve_line, text)
    return re.sub(r"[^.;!?]+", lambda sentence: _without_courtesy(sentence.group(0)), text)


def _sleeve_line(found: re.Match[str]) -> str:
    begin = {"(": "(", ",": ",", ":": ","}.get(found.group(0)[0], "")
    return f"{begin} {'along the armhole' if found['upper'] == 'shoulder' else 'at a slant'} "


def _without_courtesy(sentence: str) -> str:
    """*I'd be ever so grateful if you could fold it* is *fold it*: what stands before the request is dropped."""
    words = list(re.finditer(r"[a-z']+|[^\sa-z']", sentence))
    for place, word in enumerate(words[:_MAX_COURTESY]):
        said = word.group(0)
        before = words[max(place - 1, 0)].group(0)
        marker = said in ("to", "and") or (said == "you" and before in _LEADS_TO_YOU)
        if marker and place and _asks(words, place):
            return sentence[: words[0].start()] + sentence[words[_request(words, place)].start() :]
        if _categories(said) & _MEANT:
            break
    return sentence


def _request(words: list[re.Match[str]], place: int) -> int:
    """Where the request begins after its marker: after *could* in *if you could fold*."""
    place += 1
    while place < len(words) - 1 and words[place].group(0) in (
        "could",
        "would",
        "can",
        "might",
        "were",
        "to",
        "please",
        "just",
        "kindly",
    ):
        place += 1
    return place


def _asks(words: list[re.Match[str]], place: int) -> bool:
    before = {word.group(0) for word in words[:place]}
    follows = _request(words, place)
    return bool(before & _SPEAKERS) and follows < len(words) and "verb" in _categories(words[follows].group(0))


def _categories(word: str) -> set[str]:
    return {
        category
        for form, _ in variants(word)
        for said, category, _ in phrases().get(form, ())
        if len(said) == 1
    }  # fmt: skip
