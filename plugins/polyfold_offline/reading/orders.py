"""Orders that are read to the letter: subgoals as this backend words them, and the shortest that people give."""

from __future__ import annotations

import re
from fractions import Fraction

from polyfold_offline.cloth.folds import (
    CORNERS,
    EDGES,
    OPPOSITE_CORNER,
    OPPOSITE_EDGE,
    PART_NAMES,
    Fold,
    edge_name,
    say,
)
from polyfold_offline.cloth.garment import Garment
from polyfold_offline.meaning.program import FRACTIONS, OPPOSITE, Piece, Program
from polyfold_offline.reading.tokens import FAMILY_WORDS


def fold_of_subgoal(sentence: str, garment: Garment) -> Fold | None:
    """The fold of a subgoal that is worded as :func:`polyfold_offline.cloth.folds.say` does; None of any other."""
    words = " ".join(sentence.split()).rstrip(".")
    if strip := _STRIP.fullmatch(words):
        return Fold("band", strip["edge"], cm=float(strip["cm"]))
    return next((fold for fold in _sayable(garment) if say(fold, garment.said_as) == words), None)


_PLAIN = re.compile(
    r"(?:please )?(?:fold|bring|put|lay) (?:the )?(?P<part>[a-z ]+?) "
    r"(?:over |on |across |(?:up|down|left|right)(?:wards?)? )?(?:to|onto|on|over|top of) (?:the )?"
    r"(?P<other>[a-z ]+?)(?:,? please)?[.!]?",
    re.IGNORECASE,
)
_STRIP = re.compile(r"fold the (?P<edge>left|right|top|bottom) strip of (?P<cm>\d+(?:\.\d+)?) cm \w+ward to the rest")


def program_of_order(sentence: str, garment: Garment) -> Program | None:
    """The program of an order in the fewest words, its first length marked ``#1``; None of any other.

    Of the garment alone, *fold the shirt*, *fold it in half twice*; of a part and where it goes, *fold the bottom up*,
    *fold the left sleeve*; of a corner, *fold the top left corner to the middle*; of an edge and the opposite one,
    *fold the left edge onto the right edge*; of a strip, *turn up the hem by 4 cm*. They hold too few words for a
    network to be sure of any: one name of a garment more or less decides. Of cuffs at the shoulders, which no subgoal
    can say, a refusal.
    """
    words = " ".join(sentence.split())
    readers = (
        _program_of_garment, _program_of_part, _program_of_corner, _program_of_edges, _program_of_strip,
        _refusal_of_cuffs,
    )  # fmt: skip
    return next((program for read in readers if (program := read(words, garment)) is not None), None)


def _program_of_garment(words: str, garment: Garment) -> Program | None:
    order = _SHORTEST.fullmatch(words)
    if order is None or order["noun"].lower() not in ("it", "this", "them", *_nouns(garment)):
        return None
    return next(program for pattern, program in _RESULTS if pattern.fullmatch(order["result"] or ""))


def _program_of_edges(words: str, garment: Garment) -> Program | None:
    order = _PLAIN.fullmatch(words)
    for edge in EDGES if order else ():
        names, others = ({f"{e} edge", f"{e} side", edge_name(garment.said_as, e)} for e in (edge, OPPOSITE_EDGE[edge]))
        if order and order["part"].lower() in names and order["other"].lower() in others:
            return (Piece("half", edge[0].upper()),)
    return None


def _program_of_part(words: str, garment: Garment) -> Program | None:
    order = _OF_PART.fullmatch(words)
    if order is None:
        return None
    way = (order["way"] or "").lower()
    if order["edge"]:
        edge = order["edge"].lower()
        return (Piece("half", edge[0].upper()),) if way in (*_ANY_WAY, *_AWAY_FROM[edge]) else None
    if order["sleeve"] and garment.family == "tshirt":
        side = order["sleeve"].lower()
        sides = "LR" if side in ("the", "both", "both the") else side[0].upper()
        return tuple(Piece("sleeve", one, "any") for one in sides) if way in ("", *_INWARD) else None
    if order["corners"] and garment.plain and way in ("in", *_TO_THE_MIDDLE):
        return tuple(Piece("centre", corner) for corner in ("BL", "TL", "TR", "BR"))
    return None


def _program_of_corner(words: str, garment: Garment) -> Program | None:
    order = _OF_CORNER.fullmatch(words)
    if order is None or not garment.plain:
        return None
    corner = _corner(order["corner"])
    if order["middle"]:
        return (Piece("centre", corner),)
    other = OPPOSITE[corner] if order["other"].lower() == "opposite" else _corner(order["other"])
    return (Piece("across", corner),) if other == OPPOSITE[corner] else None


def _refusal_of_cuffs(words: str, garment: Garment) -> Program | None:
    """No subgoal halves a sleeve; without this rule the network takes cuffs at the shoulders for the hem there."""
    return (Piece("no", "unclear"),) if garment.family == "tshirt" and _OF_CUFFS.fullmatch(words) else None


def _corner(words: str) -> str:
    """``upper-left`` to ``TL``."""
    said = set(re.split("[ -]", words.lower()))
    return ("T" if said & {"top", "upper"} else "B") + ("L" if "left" in said else "R")


def _program_of_strip(words: str, garment: Garment) -> Program | None:
    order = _OF_STRIP.fullmatch(words)
    if order is None:
        return None
    edge = (_EDGES_BY_NAME | _STRIP_EDGES.get(garment.family, {})).get(order["edge"].lower())
    ways = {order[name].lower() for name in ("way", "then") if order[name]}
    return (
        (Piece("strip", edge[0].upper(), "#1"),)
        if edge and ways <= {"over", *_INWARD, *_UPRIGHT.get(edge, ())}
        else None
    )


_ANY_WAY = ("over", "across")
_AWAY_FROM = {
    "left": ("right", "to the right"), "right": ("left", "to the left"), "top": ("down",), "bottom": ("up",),
}  # fmt: skip
_INWARD = ("in", "inward", "inwards", "over")
_TO_THE_MIDDLE = tuple(f"{way}to the {middle}" for way in ("", "in") for middle in ("middle", "centre", "center"))
_WAYS = "|".join(
    sorted({*_ANY_WAY, *_INWARD, *_TO_THE_MIDDLE, *(way for ways in _AWAY_FROM.values() for way in ways)}, reverse=True)
)
_OF_PART = re.compile(
    r"(?:please,? )?fold (?:(?:the )?(?P<edge>left|right|top|bottom)(?: (?:edge|side|half|end))?"
    r"|(?:the )?(?P<sleeve>left|right|the|both|both the) sleeves?|(?P<corners>(?:all )?(?:the )?(?:four )?corners))"
    rf"(?: (?P<way>{_WAYS}))?(?:,? please)?[.!]?",
    re.IGNORECASE,
)


_CLOTHS = ("cloth", "towel", "napkin", "handkerchief", "scarf", "flannel")
_CORNER = r"(?:(?:top|upper|bottom|lower)[ -](?:left|right)|(?:left|right)[ -](?:top|upper|bottom|lower))"
_OF_CORNER = re.compile(
    rf"(?:please,? )?(?:fold|bring|take) (?:the )?(?P<corner>{_CORNER})(?:[ -]hand)? corner "
    r"(?:(?:in|inwards?|over|across|diagonally) )?(?:in)?(?:to|on|onto) the "
    rf"(?:(?P<middle>middle|cent(?:re|er))(?: of the (?:{'|'.join(_CLOTHS)}|square|rectangle|fabric))?"
    rf"|(?P<other>opposite|{_CORNER})(?: corner| one)?)(?:,? please)?[.!]?",
    re.IGNORECASE,
)
_OF_CUFFS = re.compile(
    r"(?:please,? )?(?:fold|bring|take|put|lay|turn) (?:back |up |in )?(?:both |the |each )*(?:left |right )?"
    r"(?:cuffs?|sleeve ends?|ends? of (?:the |both |each )*(?:left |right )?sleeves?) .*"
    r"\b(?:shoulders?|armpits?|collar|neck(?:line)?)\b.*",
    re.IGNORECASE,
)
_EDGES_BY_NAME = {name: edge for edge in EDGES for name in (edge, f"{edge} edge", f"{edge} side")}
_UPRIGHT = {"top": ("down", "downward", "downwards"), "bottom": ("up", "upward", "upwards")}
_STRIP_EDGES = {
    "tshirt": dict.fromkeys(("hem", "bottom hem", "lower hem"), "bottom"),
    "pants": {
        **dict.fromkeys(("hems", "cuffs", "leg ends", "ends of the legs", "trouser legs", "ankles"), "bottom"),
        **dict.fromkeys(("waist", "waistband"), "top"),
    },
}
"""What edges along which strips are turned over are called besides left, right, top and bottom edge."""

_OF_STRIP = re.compile(
    r"(?:please,? )?(?:fold|turn|flip) (?:(?P<way>over|in|up|down) )?(?:the )?"
    r"(?P<edge>[a-z ]+?)"
    r"(?: (?P<then>over|in|inwards?|up|upwards?|down|downwards?))? (?:by )?#1 cm(?:,? please)?[.!]?",
    re.IGNORECASE,
)


def _nouns(garment: Garment) -> tuple[str, ...]:
    return _NOUNS.get(garment.family, (garment.spoken, garment.kind, FAMILY_WORDS["other"]))


_NOUNS = {
    "square": (*_CLOTHS, "square", "square cloth", "bandana"),
    "rectangle": (*_CLOTHS, "rectangle", "rectangular cloth", "tea towel", "dish towel", "blanket"),
    "tshirt": ("t-shirt", "tshirt", "t shirt", "shirt", "tee"),
    "pants": ("pants", "trousers", "jeans", "pair of pants", "pair of trousers", "pair of jeans"),
}
"""What people call the garment on the table: another name means another garment, which the reader refuses."""

_HALVED = Piece("half", "any")
_RESULTS = (
    (re.compile(r"(?:up|neatly|nicely|tidily|properly| )*", re.IGNORECASE), (Piece("goal", "neat"),)),
    (re.compile(r"in half (?:twice|two times)|twice in half", re.IGNORECASE), (_HALVED, _HALVED)),
    (re.compile(r"in(?:to)? (?:quarters|fourths|four)", re.IGNORECASE), (Piece("goal", "quarter"),)),
    (re.compile(r"in(?:to)? (?:thirds|three)", re.IGNORECASE), (Piece("goal", "letter"),)),
)
"""What an order may say of the result, and what that asks for."""

_SHORTEST = re.compile(
    r"(?:please,? |(?:can|could|would) you (?:please )?)?fold (?:up )?"
    r"(?:(?:the|this|that|my|our) )?(?!in)(?P<noun>[a-z -]+?)"
    rf"(?: (?P<result>{'|'.join(pattern.pattern for pattern, _ in _RESULTS)}))?(?:,? please)?[.!?]?",
    re.IGNORECASE,
)


def _sayable(garment: Garment) -> list[Fold]:
    folds = [Fold("half", edge, manner=manner) for edge in EDGES for manner in ("", "again", "gap")]
    folds += [Fold("half", edge) for edge in ("long", "short")] + [Fold("middle", edge) for edge in EDGES]
    shares = [Fraction(share) for share in FRACTIONS if Fraction(share).denominator in PART_NAMES]
    folds += [Fold("band", edge, share=share) for edge in EDGES for share in shares]
    if garment.plain:
        folds += [Fold("corner", corner, "centre") for corner in CORNERS]
        folds += [Fold("corner", corner, other) for corner, other in OPPOSITE_CORNER.items()]
    if garment.family == "tshirt":
        folds += [Fold("sleeve", side, manner=manner) for side in EDGES[:2] for manner in ("straight", "slanted")]
    return folds
