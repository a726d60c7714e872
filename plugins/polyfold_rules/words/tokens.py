"""From a sentence to tagged tokens: normalised words, misspellings within one edit, longest known phrases."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from polyfold_rules.words.lexicon import fillers, phrases
from polyfold_rules.words.rewording import reworded
from polyfold_rules.words.spelling import number_of, spell, variants

NAMED_ASIDE = re.compile(r"\((?:[a-z0-9]+_[a-z0-9_]+|,|and|\s)+\)")
"""Vertex names in brackets, which only repeat what stands before them."""
SIDED_NAME = re.compile(r"\b(armpit|shoulder|neck|sleeve|hem|waist|leg)(?:_top|_bottom)?_(left|right|center)\b")
COUNTED = re.compile(
    r"\b(?:in|with|using|within|by|takes?)\s+(?:just |only |exactly )?(?:a total of )?(\w+)\s+"
    r"(?:\w+ )?(?:steps?|moves?|folds|stages?|foldings?|movements?|motions?|operations?|goes|actions?)\b"
)
SIZE = re.compile(
    r"(?:\b(?:in|to|into|down to) )?(?:\b(?:a|an|one|its) )?\b(half|third|quarter|fourth|eighth) (?:of )?"
    r"(?:the |its |their )?"
    r"(?:\w+ )?(?:size|area|footprint)\b"
)
PLURAL_FOLDS = re.compile(r"\b(\w+)\s+(diagonal |half |simple |straight |single )?folds\b")
SIMILE = re.compile(
    r"\b(?:(?:make|making) it )?(?:looks? |looking )?like (?!they do|you|i |it |to\b|that\b|this\b)[^,.;:]*"
)
SIMILES = {
    "shutter": "like shutters", "door": "like shutters", "cupboard": "like shutters", "gate": "like shutters",
    "window": "like shutters", "cabinet": "like shutters", "wardrobe": "like shutters", "book": "like a book",
    "letter": "like a letter", "envelope": "like an envelope", "blintz": "like an envelope", "shop": "like in a shop",
    "store": "like in a shop", "accordion": "pleat", "concertina": "pleat", "zigzag": "pleat", "burrito": "roll",
    "sausage": "roll", "scroll": "roll", "tube": "roll", "fan": "pleat",
}  # fmt: skip
"""Comparisons that say how to fold; others are dropped: *like the first step of a paper plane*."""
LISTED = re.compile(r"(?:^|(?<=[\s.,;]))\(?\d[.)]\s")
ANY_ORDER = re.compile(r"(?:the )?order (?:does not|doesn't|is not|isn't) (?:matter|important)|no matter the order")
HANDS = re.compile(
    r"\b(?:with|using) (?:one|both|two|your|the|its) (?:robot |robotic )?(?:arm|hand|gripper)s?(?: on)?\b"
)
QUARTER_WAY = re.compile(r"\b(?:a |one )?quarter of the way(?: in| up| down| across)?(?: from the \w+)?\b")
ADVERB = re.compile(
    r"(?<=[a-z] )(?<!the )(?<!top )(?<!bottom )(?<!upper )(?<!lower )(?<!left )(?<!and )(?<!then )(?<!over )(?<!onto )"
    r"(?<!on )(?<!to )(?<!from )(?<!first )(?<!with )(?<!its )(?<!far )(?<!fold )(?<!bring )(?<!or )"
    r"right (?=(?:in|on|onto|at|over|along|to|into|where|across|up|down) (?:the|its|to)\b)"
    r"|(?<=, )right (?=(?:at|where|along) (?:the|its)\b)"
)
"""*Right* that means *just*: *right at the seam*, *lands right in the centre*."""
STATE = re.compile(
    r"\b(?:once|when|after|now that|as soon as) (?:you (?:have|get|got)|it is|it has become|there is|that is) "
    r"(?:a|an|the|your|that|this) (?!left|right|top|bottom|upper|lower)[^,.;:]*,"
)
"""A result reached before the next clause: *once you have the triangle, ...*."""
ROUND = re.compile(
    r",?\s*(?:and )?(?:then )?(?:(?:going|working|moving|proceeding|continuing) )(?:your way )?"
    r"(?:(?:a)?round )?(?:the (?:cloth|square|napkin|corners) )?(?:in )?(?:a )?"
    r"(?:(?:counter|anti)?-?clockwise|(?:a)?round)(?: (?:direction|order|around|round))?"
    r"(?= (from)\b| starting\b|[,.;]|$)"
    r"(?: from)?"
)
"""*Going round clockwise from the bottom left*: corners are told one after the other in that order anyway."""
AND_BACK = re.compile(r"\band (?:then )?back(?: out)?(?: again)?(?= ?[.,;]| ?$)")
FOLD_LINE = re.compile(r"\b(the|a|this|that) fold (?=(?:at|along|run|runs|running|goes|going|lies|lying|from)\b)")
HALF_AS = re.compile(r"\bhalf as (wide|tall|high|long|big|large|deep)\b(?: as (?:before|it was|now))?")
HALF_AS_MANNER = {"wide": "sideways", "tall": "horizontally", "high": "horizontally", "deep": "horizontally"}
AND_SMALLER = re.compile(r"\band (?:then )?(?:into )?an? (?:even )?smaller (?:one|triangle)(?: still)? (?:by|with)\b")
AT_ONCE = re.compile(
    r",? (?:with )?(?:both|all)(?: of)?(?: the| its)?(?: two)? (?:legs|layers|halves|plies|ends) "
    r"(?:at once|together|at the same time|as one|in one go)(?= ?[,.;]|$)"
)
"""An aside that all layers go along, which every fold takes anyway."""
A_LITTLE = re.compile(
    r"\ba (?:little|tiny|wee)(?: bit)?(?=[,.;]|$| (?:further|farther|over|up|down|in|past|short|beyond|towards?)\b)"
)
LINES_THAT_CROSS = r"(?:the |its |both |two |these )*(?:diagonals|(?:middle|centre|center|mid) ?lines|midlines|axes)"
CROSSING = re.compile(
    rf"(?:(?:point|place|spot|position) )?(?:where|at which|in which) {LINES_THAT_CROSS} "
    r"(?:would |will )?(?:cross|meet|intersect)(?: each other)?\b"
    rf"|(?:intersection|crossing|meeting)(?: point)? of {LINES_THAT_CROSS}"
)
"""The centre, told by what crosses there."""
NEXT_PART = re.compile(r"\b(then|next|now),? (?:go|turn|move|switch)(?: over| on)? to (?=(?:the|its) )")
TIMES = re.compile(r"\b(\d+|[a-z]+)\s+(?:more |separate |whole )?times\b(?! smaller)")


@dataclass(frozen=True)
class Token:
    """A known phrase: its category and value in the lexicon, the words it stands for and their grammatical form."""

    category: str
    value: str
    text: str
    plural: bool = False
    form: str = "base"

    def is_(self, category: str, *values: str) -> bool:
        """Whether it has this category and, if any are given, one of these values."""
        return self.category == category and (not values or self.value in values)


@dataclass(frozen=True)
class Sentence:
    """A tagged instruction; ``corrections`` are misspellings read as known words."""

    tokens: tuple[Token, ...]
    corrections: tuple[tuple[str, str], ...]


def read(text: str) -> Sentence:
    """Tag an instruction."""
    plain = _plain(text)
    plain = SIMILE.sub(_simile, plain)
    plain = ADVERB.sub("", plain)
    plain = FOLD_LINE.sub(r"\1 crease ", plain)
    plain = HALF_AS.sub(lambda found: f"in half {HALF_AS_MANNER.get(found.group(1), '')}", plain)
    plain = AND_SMALLER.sub(", then ", plain)
    plain = AND_BACK.sub(" and unfold it", plain)
    plain = AT_ONCE.sub(" ", plain)
    plain = A_LITTLE.sub("slightly", plain)
    plain = CROSSING.sub("centre", plain)
    plain = STATE.sub(" then ", plain)
    plain = ROUND.sub(lambda found: ", starting with" if found.group(1) else "", plain)
    plain = NEXT_PART.sub(r"\1 take ", plain)
    plain = LISTED.sub(". ", plain)
    plain = COUNTED.sub(_count("stepcount"), plain)
    plain = PLURAL_FOLDS.sub(_count("stepcount", keep=2), plain)
    plain = TIMES.sub(_count("timescount"), plain)
    words = re.findall(r"[a-z0-9']+|[.,;:!?()]", plain)
    corrections: list[tuple[str, str]] = []
    fixed = [spell(word, corrections) for word in words]
    return Sentence(tuple(_tag(fixed)), tuple(corrections))


def _plain(text: str) -> str:
    text = unicodedata.normalize("NFKD", text.lower()).replace("\u2019", "'").replace("\u2018", "'")
    text = reworded(re.sub(r"\b(?:i|we)(?:'d| would)? like\b", " ", text))
    text = re.sub(r"\blower (?=the |its |it\b)", "bring down ", text)
    text = NAMED_ASIDE.sub(" ", text)
    text = re.sub(r"\bi\.e\.|\be\.g\.", " ", text).replace("ontop", "on top")
    text = ANY_ORDER.sub(" ", text)
    text = HANDS.sub(" ", text)
    if re.search(r"mid|cent", text):
        text = QUARTER_WAY.sub(" ", text)
    text = re.sub(r"(_(?:left|right))\s*-\s*(?=[a-z]+_)", r"\1 to ", text)
    text = SIDED_NAME.sub(r"\2 \1", text.replace("leg_outer", "leg").replace("leg_inner", "leg"))
    text = (
        text.replace("\u2014", ", ")
        .replace("\u2013", ", ")
        .replace(" - ", ", ")
        .replace("&", " and ")
        .replace("->", " to ")
    )
    text = re.sub(r"can(?:no|')t\b", "can not", text)
    text = re.sub(r"n't\b", " not", text).replace("dont ", "do not ")
    text = re.sub(r"'(?:s|ve|ll|d|re|m)\b", "", text).replace("s' ", "s ")
    text = re.sub(r"(?<!\w)-(?=\d)", "minus ", text)
    text = re.sub(r"\b(?:one|1)\s*/\s*4\b|\b1/4\b", " quarter ", text)
    text = re.sub(r"\b1/3\b", " third ", text)
    text = re.sub(r"\b1/2\b", " half ", text)
    text = re.sub(r"\b(\d+)(?:x)\b", r"\1 times", text)
    text = SIZE.sub(r" in \1s ", text)
    text = re.sub(r"\bt-?shirt", "tshirt", text)
    return text.replace("-", " ").replace("/", " ").replace('"', " ").replace("centre's", "centre")


def _count(name: str, keep: int = 0):
    """Replace a counted noun by one word that carries the number; ``keep`` is a group to leave in the text."""

    def replace(match: re.Match[str]) -> str:
        number = number_of(match.group(1))
        kept = f"{match.group(keep) or ''} fold" if keep else ""
        return match.group(0) if number is None else f" {kept} {name}{number} "

    return replace


def _simile(match: re.Match[str]) -> str:
    known = next((phrase for word, phrase in SIMILES.items() if word in match.group(0)), None)
    cut = re.search(r"\b(?:and|then|with|by|so|from|until|along)\b.*", match.group(0))
    return f"{known or ''} {cut.group(0) if cut else ''}"


def _tag(words: list[str]) -> list[Token]:
    tokens: list[Token] = []
    at = 0
    while at < len(words):
        token, used = _match(words, at)
        if token is not None and token.category == "frac" and words[at] == "half" and tokens and tokens[-1].is_("side"):
            token, used = Token("noun", "half", "half"), 1
        if token is not None:
            tokens.append(token)
        at += used
    return tokens


def _match(words: list[str], at: int) -> tuple[Token | None, int]:
    word = words[at]
    for name, category in (("stepcount", "steps"), ("timescount", "times")):
        if word.startswith(name):
            return Token(category, word.removeprefix(name), word), 1
    if word in ":()":
        return Token("join", "colon" if word == ":" else "comma", word), 1
    if word in ".;!?":
        return Token("stop", word, word), 1
    if word == ",":
        return Token("join", "comma", word), 1
    best: tuple[int, int, Token] | None = None
    for variant, form in variants(word):
        for phrase, category, value in phrases().get(variant, ()):
            last_form = _fits(words, at, phrase)
            if last_form is None or (len(phrase) == 1 and not _allowed(category, form)):
                continue
            plural = last_form == "plural" and category in ("noun", "garment")
            spoken = " ".join(words[at : at + len(phrase)])
            token = Token(category, value, spoken, plural, form if category == "verb" else "base")
            rank = (len(phrase), 1 if form == "base" else 0)
            if not _cut_off(token, words, at + len(phrase)) and (best is None or rank > best[:2]):
                best = (*rank, token)
    if best is not None:
        return best[2], best[0]
    if number_of(word) is not None:
        return Token("number", str(number_of(word)), word), 1
    if any(variant in fillers() for variant, _ in variants(word)) or word.endswith("ly"):
        return None, 1
    adjective = at > 0 and words[at - 1] in (
        "the",
        "a",
        "an",
        "its",
        "my",
        "your",
        "this",
        "that",
        "two",
        "both",
        "neat",
    )
    return Token("unknown", word, word, form="adjective" if adjective else "base"), 1


FILLER_WORDS = frozenset(fillers())


def _allowed(category: str, form: str) -> bool:
    """Only nouns have plurals and only verbs have -ing and -ed."""
    if form == "base":
        return True
    return category == "verb" or (form == "plural" and category in ("noun", "garment"))


def _fits(words: list[str], at: int, phrase: tuple[str, ...]) -> str | None:
    """The grammatical form of the last word if the phrase stands at this place."""
    if at + len(phrase) > len(words):
        return None
    form = "base"
    for word, wanted in zip(words[at:], phrase, strict=False):
        forms = dict(reversed(variants(word)))
        if wanted not in forms:
            return None
        form = forms[wanted]
    return form


def _cut_off(token: Token, words: list[str], after: int) -> bool:
    """``to the right`` is a direction, but not in ``to the right edge`` or ``to the left and right``."""
    if after >= len(words):
        return False
    following = {variant for variant, _ in variants(words[after])}
    ends_in_side = token.text.split()[-1] in ("left", "right", "top", "bottom")
    if token.category in ("dir", "manner") and ends_in_side and (following & PART_WORDS or "hand" in following):
        return True
    if (
        token.is_("quant", "opposite")
        and token.text.endswith("across")
        and words[after] in ("the", "its", "your", "to")
    ):
        return True
    if token.category == "side" and token.value in ("long", "short") and following & {"sleeved", "sleeve"}:
        return True
    return token.category == "frac" and bool(following & {"step", "fold", "move", "time"})


PART_WORDS = frozenset(
    {
        "corner", "edge", "side", "sleeve", "leg", "half", "third", "quarter", "border", "shoulder", "hem", "one",
        "part", "bottom", "top", "upper", "lower", "hand", "end", "arm", "cuff", "flap", "point", "left", "right",
        "armpit", "neck", "collar", "armhole", "portion", "margin", "panel", "waist", "vertex",
    }
)  # fmt: skip
