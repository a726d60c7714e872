"""Variation of sentences whose meaning changes in a known way, or not at all."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from random import Random

from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.folding import folds_of
from polyfold_offline.meaning.program import LENGTHS, Piece, Program
from polyfold_offline.training.asides import with_aside
from polyfold_offline.training.corpus import Example, rename

_MAX_STEPS = 5


def vary(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """One more sentence, from a written one.

    Args:
        example: what to begin with.
        others: family -> sentences to combine it with.
        random: where choices come from.
    """
    for share, change in _CHANGES:
        if random.random() < share:
            example = change(example, others, random)
    return example


# Mirrored garments ---------------------------------------------------------------------------------------------------

_SIDES = {"left": "right", "west": "east", "western": "eastern", "port": "starboard", "leftmost": "rightmost"}
_SIDES |= {"leftward": "rightward", "leftwards": "rightwards", "westward": "eastward", "lefthand": "righthand"}
_ENDS = {"top": "bottom", "upper": "lower", "north": "south", "northern": "southern", "up": "down", "above": "below"}
_ENDS |= {"upward": "downward", "upwards": "downwards", "uppermost": "lowermost", "topmost": "bottommost"}
_NO_MIRROR = re.compile(
    r"o'?clock|half past|clock|\bhour|\b(?:rite|wright|write|lefft|rihgt|lft|rgt|rght|gauche|droite|sinistr|destr|izqui"
    r"|derech|links|recht|larboard|all right|that's right|right\?)|[←→↑↓⬅➡⬆⬇↗↘↙↖👈👉👆👇]|\bL\b|\bR\b"
)
_NO_FLIP = re.compile(
    r"\b(?:end|ends|wrap|tidy|pick|lift|give|hurry|clean|line|lines|lining|match|fold|folds|folded|folding|finish|close"
    r"|pull|double|made|make|wind|come|comes|shut|turn|face|mess|settle|calm|sit|lay|lie|lies|put|set|write|stack|pile"
    r"|put|wake|cheer|speak|stand|buckle|slow|cut|break|go|going|boil) (?:\w+ )?(?:up|down)\b|\bon top\b|above all"
    r"|\b(?:near|nearest|closest|far|farthest|furthest|away|toward me|towards me|roof|floor|sky|head|foot|feet|ceiling"
    r"|ground|attic|cellar|hem|neck|waist)\b|top (?:of|layer)|\bover the top\b|\bT\b|\bB\b"
)
_ADVERB = (
    r"(?!\s+(?:up|down|over|in|into|away|now|on top|onto|back|across|there|here|through|at|then|after|so"
    r"|to the (?:mid|cent|heart)))"
)
"""What follows *right* where it is no side."""


def _swap(words: Mapping[str, str]) -> tuple[re.Pattern[str], dict[str, str]]:
    both = {**words, **{value: key for key, value in words.items()}}
    names = "|".join(sorted(both, key=len, reverse=True)).replace("right|", f"right{_ADVERB}|")
    return re.compile(rf"\b(?:{names})\b", re.IGNORECASE), both


def _replaced(text: str, words: Mapping[str, str]) -> str:
    pattern, both = _swap(words)

    def other(match: re.Match[str]) -> str:
        word = both[match[0].lower()]
        return word.upper() if match[0].isupper() and len(word) > 1 else word.title() if match[0][0].isupper() else word

    return pattern.sub(other, text)


_MIRRORED = {"L": "R", "R": "L", "BL": "BR", "BR": "BL", "TL": "TR", "TR": "TL"}
_MIRRORED |= {"point-L": "point-R", "point-R": "point-L"}
_FLIPPED = {"T": "B", "B": "T", "BL": "TL", "TL": "BL", "BR": "TR", "TR": "BR"}
_FLIPPED |= {"point-T": "point-B", "point-B": "point-T"}


def _mirror(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    if _NO_MIRROR.search(example.text):
        return example
    return _seen_otherwise(example, _SIDES, _MIRRORED)


def _flip(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    plain = example.family in ("square", "rectangle")
    if not plain or _NO_MIRROR.search(example.text) or _NO_FLIP.search(example.text):
        return example
    return _seen_otherwise(example, _ENDS, _FLIPPED)


def _seen_otherwise(example: Example, words: Mapping[str, str], places: dict[str, str]) -> Example:
    """The example with sides exchanged; unchanged where what it leaves open is settled by an order of sides."""
    text, program = _replaced(example.text, words), rename(example.program, places)
    if text == example.text or (_told_together(example.program) and _TOGETHER.search(example.text)):
        return example
    return Example(example.family, text, program, example.register)


_TOGETHER = re.compile(
    r"\b(?:both|all|each|every|any|two|three|four|pair|sleeves|arms|wings|corners|sides|edges|ends|flaps|thirds|tips"
    r"|points|doors|leaves|rest|others?|either|whole)\b",
    re.IGNORECASE,
)
"""Words by which several parts are named at once, so that their order is the usual one (``MEANINGS.md``)."""


def _told_together(program: Program) -> bool:
    return any(a.operation == b.operation != "half" for a, b in pairwise(program))


# Sentences put together ----------------------------------------------------------------------------------------------

_THEN = (
    ". Then ",
    ", then ",
    "; ",
    ". ",
    " and then ",
    ", and after that ",
    ". After that, ",
    ", next ",
    " and ",
    " - then ",
)
_THEN += (". Once that's done, ", ". Next: ", " then ", ", followed by this: ", ". Finally ", " -> ", "\n")
_AFTER = (
    "{last} - but before that: {first}", "Last: {last} First: {first}", "{last} Prior to this, {first}",
    "The second thing is: {last} The first thing is: {first}", "Finish with this: {last} But begin like so: {first}",
    "{last} Only do so after this: {first}", "Before you come to “{last}” do this: {first}",
)  # fmt: skip
_TOLD_BACKWARDS = 0.2
_CORRECTED = (
    " - no wait, ", "... no, scratch that: ", ". Actually no, ", ", sorry, I mean: ", " hmm no. ", ". Forget that. ",
    ", or rather, ", " -- correction: ", ". On second thought, ", " oops, not that: ", " no no no, instead ",
)  # fmt: skip


def _is_steps(example: Example) -> bool:
    return example.program[0].operation not in ("no", "goal")


def _another(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """Another sentence about this kind of garment, of the same register if there is one."""
    for _ in range(8):
        other = random.choice(others[example.family])
        if other.register == example.register and other is not example:
            return other
    return random.choice(others[example.family])


def _continued(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    other = _another(example, others, random)
    if not (_is_steps(example) and _is_steps(other)):
        return example
    program = example.program + _after(other, example)
    if len(program) > _MAX_STEPS or not _makes_sense(program, example.family):
        return example
    told, later = example.text.rstrip(" .!"), _shifted(other.text, example)
    if random.random() < _TOLD_BACKWARDS and not (_marks(example) and _marks(other)):
        return Example(example.family, random.choice(_AFTER).format(first=told, last=later), program, example.register)
    return Example(example.family, f"{told}{random.choice(_THEN)}{later}", program, example.register)


def _corrected(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    wrong = _another(example, others, random)
    if not (_is_steps(example) and _is_steps(wrong)) or len(wrong.program) > 2:
        return example
    text = f"{wrong.text.rstrip(' .!')}{random.choice(_CORRECTED)}{_shifted(example.text, wrong)}"
    return Example(example.family, text, _after(example, wrong), example.register)


def _marks(example: Example) -> int:
    return sum(mark in example.text for mark in LENGTHS)


def _after(example: Example, before: Example) -> Program:
    """The program of a sentence whose lengths are counted on from those of another."""
    shift = _marks(before)
    return rename(example.program, {f"#{i}": f"#{i + shift}" for i in range(1, 5)})


def _shifted(text: str, before: Example) -> str:
    shift = _marks(before)
    return re.sub(r"#(\d)", lambda match: f"#{int(match[1]) + shift}", text) if shift else text


def _makes_sense(program: Program, family: str) -> bool:
    try:
        folds_of(program, (5.0,) * 8, Garment(family, family, {}, (60.0, 80.0)))
    except NotUnderstoodError:
        return False
    words = {word for piece in program for word in (piece.place, piece.detail)}
    return not {"#5", "#6", "#7", "#8"} & words


_FOREIGN = {
    "tshirt": (r"\bsleeves?\b|\bshoulders?\b|\bcollar\b|\bneckline\b|\barmpits?\b", "part"),
    "pants": (r"\blegs?\b|\bwaist(?:band)?\b|\bankles?\b", "part"),
    "square": (r"\bcorners?\b", "part"),
    "rectangle": (r"\bcorners?\b", "part"),
}
_WITHOUT = {"tshirt": ("square", "rectangle", "pants"), "pants": ("square", "rectangle", "tshirt")}
_WITHOUT |= {"square": ("pants", "tshirt"), "rectangle": ("tshirt", "pants")}


def _elsewhere(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """The sentence said of a garment that lacks what it names."""
    pattern, reason = _FOREIGN.get(example.family, ("$^", "part"))
    if example.program[0].operation not in ("sleeve", "half", "centre", "across") or not re.search(
        pattern, example.text
    ):
        return example
    family = random.choice(_WITHOUT[example.family])
    return Example(family, example.text, (Piece("no", reason),), example.register)


def _beside_the_point(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """A remark before or after the wish."""
    remarks = [e for e in others[example.family] if e.program == (Piece("no", "nonsense"),) and len(e.text) < 90]
    remark = random.choice(remarks).text if remarks else ""
    if not remark or re.search(r"ignore|forget|prompt|instruction|json|rule", remark, re.IGNORECASE) or _marks(example):
        return example
    text = f"{remark} {example.text}" if random.random() < 0.6 else f"{example.text} {remark}"
    return Example(example.family, text, example.program, example.register)


def _added(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    return with_aside(example, random)


# Words that don't matter ----------------------------------------------------------------------------------------------

_MATTERS = frozenset(Path(__file__).with_name("words_that_matter.txt").read_text(encoding="utf-8").split())
"""Words that tell what is folded where; others may be exchanged without changing the folds."""

_EXCHANGED = 0.35
_PLAIN_WORD = re.compile(r"[A-Za-z']+")


def _reworded(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """The same steps, with other verbs, names and asides: a reader shouldn't lean on those."""
    if not _is_steps(example):
        return example

    def exchanged(match: re.Match[str]) -> str:
        word = match[0].lower()
        if len(word) < 4 or word in _MATTERS or random.random() > _EXCHANGED:
            return match[0]
        other = random.choice(others[example.family])
        words = [w for w in _PLAIN_WORD.findall(other.text) if len(w) > 3 and w.lower() not in _MATTERS]
        return random.choice(words) if words and _is_steps(other) else match[0]

    return Example(example.family, _PLAIN_WORD.sub(exchanged, example.text), example.program, example.register)


# Noise ---------------------------------------------------------------------------------------------------------------

_NEIGHBOURS = {
    a: b for row in ("qwertyuiop", "asdfghjkl", "zxcvbnm") for a, b in zip(row, row[1:] + row[-2], strict=True)
}


def _mistyped(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    rate = random.choice((0.08, 0.15, 0.3))
    words = [_typo(w, random) if len(w) > 3 and random.random() < rate else w for w in example.text.split(" ")]
    return Example(example.family, " ".join(words), example.program, example.register)


def _typo(word: str, random: Random) -> str:
    at = random.randrange(1, len(word) - 1)
    if not word[at].isalpha():
        return word
    kind = random.randrange(4)
    if kind == 0:
        return word[:at] + word[at + 1] + word[at] + word[at + 2 :]
    if kind == 1:
        return word[:at] + word[at + 1 :]
    if kind == 2:
        return word[:at] + word[at] * 2 + word[at + 1 :]
    return word[:at] + _NEIGHBOURS.get(word[at].lower(), word[at]) + word[at + 1 :]


_HEARD = {
    "to": ("too", "two"), "half": ("haf", "have"), "sleeve": ("sleave", "slieve"), "right": ("rite", "write"),
    "hem": ("him", "ham"), "centre": ("senter", "center"), "center": ("senter", "sent her"),
    "corner": ("korner", "coroner"), "edge": ("ej", "hedge"), "fold": ("foled", "phoned"), "waist": ("waste", "wayst"),
    "leg": ("lag", "legg"), "over": ("ova", "ovver"), "upper": ("uper", "up her"), "bottom": ("bottum", "button"),
    "middle": ("midel", "middel"), "one": ("wun", "won"), "shoulders": ("sholders", "soldiers"),
    "sleeves": ("sleaves", "leaves"), "four": ("for", "fore"), "by": ("bye", "buy"), "line": ("lyne", "lion"),
    "side": ("syde", "sighed"), "then": ("than", "den"), "ends": ("enz", "hands"), "legs": ("legz", "lags"),
    "towel": ("towl", "tower"), "triangle": ("tryangle", "try angle"),
}  # fmt: skip


def _misheard(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    """As a speech recogniser or someone who spells by ear writes it."""

    def heard(match: re.Match[str]) -> str:
        return random.choice(_HEARD[match[0]]) if match[0] in _HEARD and random.random() < 0.4 else match[0]

    text = re.sub(r"[a-z]+", heard, re.sub(r"[.,;:!?\"()]", "", example.text.lower()))
    return Example(example.family, text, example.program, example.register)


def _unpunctuated(example: Example, others: Mapping[str, Sequence[Example]], random: Random) -> Example:
    text = re.sub(r"[.,;:!?\"()]", "", example.text)
    return Example(example.family, text, example.program, example.register)


_Change = Callable[[Example, Mapping[str, Sequence[Example]], Random], Example]
_CHANGES: Sequence[tuple[float, _Change]] = (
    (0.5, _mirror), (0.25, _flip), (0.12, _continued), (0.05, _corrected), (0.04, _elsewhere),
    (0.05, _beside_the_point), (0.25, _added), (0.2, _reworded), (0.06, _misheard), (0.12, _mistyped),
    (0.1, _unpunctuated),
)  # fmt: skip
"""How often each change is made, in the order in which they are."""
