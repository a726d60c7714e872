"""Sentence to folds: the learned reader, how sure it is, and what it says where it is not."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from polyfold_offline.cloth.folds import Fold, say
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.allowing import LEFT_OPEN, allowance
from polyfold_offline.meaning.folding import REASONS, Folding, folds_of
from polyfold_offline.meaning.program import Piece, Program
from polyfold_offline.reading.decoding import Candidate, likeliest
from polyfold_offline.reading.english import is_english
from polyfold_offline.reading.network import Network
from polyfold_offline.reading.orders import fold_of_subgoal, program_of_order
from polyfold_offline.reading.pieces import Pieces
from polyfold_offline.reading.text import Read, take_lengths
from polyfold_offline.reading.tokens import FAMILIES, FAMILY_WORDS


@dataclass(frozen=True)
class Reading:
    """One way to understand a sentence.

    Attributes:
        program: what it asks for, in the words of the reader.
        folding: the folds that this is on the garment; None where it is refused.
        reason: why it is refused, or empty.
        sure: how likely it is that these folds are meant, 0 to 1.
    """

    program: Program
    folding: Folding | None
    reason: str
    sure: float

    @property
    def limit(self) -> float:
        """The most that may be asked for, as sureness, for this to be answered.

        What leaves the way open is answered sooner: a wish, or one step of any part, is right in several ways.
        """
        wish = self.program[0].operation == "goal"
        open_step = len(self.program) == 1 and self.program[0].place in LEFT_OPEN
        return self.sure / _ENOUGH_IF_OPEN if wish or open_step else self.sure


_ENOUGH_IF_OPEN = 0.75
"""The share of sureness that suffices where the way is left open. Of 1,920 sentences for development, 9 that were read
so lie between this and the whole limit: 7 are right, 1 asks for another fold, 1 was to be refused."""


class Reader:
    """Reads sentences with a network."""

    def __init__(self, folder: Path, sure: float) -> None:
        """Args:
        folder: holds ``reader.safetensors``, ``pieces.json`` and ``words.json``.
        sure: readings that are less likely than this are refused; see :attr:`Reading.limit`.
        """
        self._network = Network.load(folder / "reader.safetensors")
        self._pieces = Pieces.load(folder)
        self._sure = sure

    def folds(self, sentence: str, garment: Garment) -> Folding:
        """The folds that a sentence asks for.

        Raises:
            NotUnderstoodError: with the reason, and the nearest thing that can be done where there is one.
        """
        if (fold := fold_of_subgoal(sentence, garment)) is not None:
            return Folding(garment, folds=[fold])
        readings = self.readings(sentence, garment)
        best = readings[0]
        if best.limit >= self._sure:
            if best.folding is None:
                raise NotUnderstoodError(best.reason)
            return best.folding
        raise NotUnderstoodError(self._doubt(sentence, garment, readings))

    def readings(self, sentence: str, garment: Garment) -> list[Reading]:
        """The ways to understand a sentence, the likeliest first; those with the same folds are one."""
        if not is_english(sentence, self._pieces.words):
            return [Reading((Piece("no", "nonsense"),), None, _ENGLISH_ALONE, 1.0)]
        if _OTHER_WORK.match(sentence):
            return [Reading((Piece("no", "action"),), None, REASONS["action"], 1.0)]
        if _TAKEN_BACK.search(sentence):
            return [Reading((Piece("no", "contradiction"),), None, "it takes back what it asks for", 1.0)]
        read = take_lengths(_in_known_words(sentence, garment))
        if (program := program_of_order(read.text, garment)) is not None:
            return [_read_to_the_letter(program, read, garment)]
        candidates = likeliest(self._network, self._pieces.read(read.text, garment.family), garment.family)
        if _SAME_AGAIN.search(read.text) and not _OTHER_WAY.search(read.text):
            candidates = [replace(candidate, program=_same_again(candidate.program)) for candidate in candidates]
        if _ONCE_MORE.search(read.text):
            candidates = [replace(candidate, program=_not_one_round(candidate.program)) for candidate in candidates]
        return _together(candidates if _SECOND_STATEMENT.search(read.text) else _consistent(candidates), read, garment)

    def _doubt(self, sentence: str, garment: Garment, readings: Sequence[Reading]) -> str:
        """Why a sentence is refused: the part of it that is in doubt, and what it might mean."""
        part = self._doubtful_part(sentence, garment)
        reason = f"I am not sure what “{part}” means" if part else "I am not sure what it means"
        nearest = next((reading for reading in readings if reading.folding is not None), None)
        if nearest is None or nearest.folding is None:
            return reason
        told = ", then ".join(say(fold, garment.said_as) for fold in nearest.folding.folds)
        return f"{reason}; did you mean: {told}?"

    def _doubtful_part(self, sentence: str, garment: Garment) -> str:
        """The clause without which the reader is surest of the rest; empty if the sentence has but one."""
        clauses = [part for part in _CLAUSES.split(sentence) if part and part.strip()]
        if not 1 < len(clauses) <= _MANY_CLAUSES:
            return " ".join(sentence.split()[:_LONG]) if sentence.strip() else ""
        doubts = [self.readings(clause, garment)[0].sure for clause in clauses]
        return clauses[doubts.index(min(doubts))].strip()


_ENGLISH_ALONE = "I read English alone, and find none here; say what to fold in plain words, or choose a language model"

_OTHER_WORK = re.compile(
    r"\W*(?:please |now |just )*(?:unfold|unroll|unwrap|iron|wash|rinse|soak|wring|starch|bleach|dye|sew|stitch|mend"
    r"|embroider|tear|rip)\b"
    r"|.*(?:\b(?:and|then|finally|yes)|[,.;!?]) (?:then |finally |also )?"
    r"(?:iron|wash|rinse|soak|wring|starch|bleach|dye|sew|stitch|embroider|rip|staple|glue|tape|unfold|unroll) "
    r"(?:it|them|the|this|that|these|those|both|all|everything)\b",
    re.IGNORECASE | re.DOTALL,
)
"""Orders of other work, first or among others: of 84 such sentences written to learn from or to
develop with, none is one to fold."""

_TAKEN_BACK = re.compile(
    r"\b(?:never ?mind|forget (?:it|that|about it|the whole thing)|cancel (?:it|that|everything)|scratch (?:it|that)"
    r"|don'?t do anything|do nothing|leave (?:it|everything) (?:as it is|alone))"
    r"(?:,? (?:please|after all|then|sorry|thanks))*\W*$",
    re.IGNORECASE,
)
"""What a person ends with who wants nothing done after all."""

_SAME_AGAIN = re.compile(
    r"\b(?:(?:the )?same (?:again|way|direction|thing|fold|once more)|(?:and|then) the same|again(?:,? the)? same"
    r"|repeat(?:ed)?|do (?:it|that|this) (?:again|once more)|(?:and|then) (?:again|once more)(?=\W*(?:$|done)))\b",
    re.IGNORECASE,
)
_OTHER_WAY = re.compile(
    r"\b(?:other|opposite|different|crosswise|crossways|perpendicular|sideways|across|any way|whichever)\b",
    re.IGNORECASE,
)
"""A fold that is to be done again goes the same way as before, unless another way is spoken of."""

_ONCE_MORE = re.compile(
    r"\b(?:again|once more|twice|repeat|(?:second|one more|another) time|two rounds)\b", re.IGNORECASE
)
_CORNERS = {Piece("centre", corner) for corner in ("BL", "TL", "TR", "BR")}

_SECOND_STATEMENT = re.compile(
    r"[,;:!?\n]|\.(?=\s*\w)|\b(?:and|but|while|whilst|yet|although|though|without|also|same|only|just|both|one|once|single|or|"
    r"stay|stays|keep|keeping|leave|leaving|at|not|don't|never)\b",
    re.IGNORECASE,
)
"""Something that a sentence could contradict itself with."""

_CLAUSES = re.compile(r"\.+(?!\d)|[;:!?\n]+|,\s+(?:and\s+)?(?:then\s+)?|\s+(?:and\s+)?then\s+")
_MANY_CLAUSES = 8
_LONG = 25


def _read_to_the_letter(program: Program, read: Read, garment: Garment) -> Reading:
    try:
        return Reading(program, folds_of(program, read.lengths, garment), "", 1.0)
    except NotUnderstoodError as error:
        return Reading(program, None, str(error), 1.0)


def _same_again(program: Program) -> Program:
    """A half fold along an edge that is named, then one whose way is left open: along the same edge."""
    found = list(program)
    for number, (before, piece) in enumerate(pairwise(program), 1):
        if piece == Piece("half", "any") and before.operation == "half" and before.place != "any":
            found[number] = found[number - 1]
    return tuple(found)


def _not_one_round(program: Program) -> Program:
    """All corners to the centre is not what somebody means who asks for a second round; that has no program."""
    return (Piece("no", "impossible"),) if len(program) == len(_CORNERS) and set(program) == _CORNERS else program


def _consistent(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates of a sentence that makes one statement, which can't contradict itself: the others, made likelier."""
    kept = [candidate for candidate in candidates if candidate.program[0] != Piece("no", "contradiction")]
    if not kept:
        return list(candidates)
    left = sum(math.exp(candidate.score) for candidate in kept)
    whole = sum(math.exp(candidate.score) for candidate in candidates)
    return [replace(candidate, score=candidate.score + math.log(whole / left)) for candidate in kept]


def _together(candidates: Sequence[Candidate], read: Read, garment: Garment) -> list[Reading]:
    """Readings from candidates: each outcome once, with the probability that it is one way to do what is asked for.

    So the ways that readings leave open are weighed together: where both *either half* and *the top half* are
    likely, the top half is likelier right than the bottom one.
    """
    folded: dict[tuple[Fold, ...], tuple[Candidate, Folding]] = {}
    refused: list[tuple[Candidate, str]] = []
    for candidate in candidates:
        try:
            folding = folds_of(candidate.program, read.lengths, garment)
            folded.setdefault(tuple(folding.folds), (candidate, folding))
        except NotUnderstoodError as error:
            refused.append((candidate, str(error)))
    readings: list[tuple[Reading, float]] = []
    if refused:
        sure = sum(math.exp(candidate.score) for candidate, _ in refused)
        readings.append((Reading(refused[0][0].program, None, refused[0][1], min(1.0, sure)), sure))
    for folds, (candidate, folding) in folded.items():
        sure = sum(allowance(it.program, read.lengths, garment, folds) * math.exp(it.score) for it in candidates)
        readings.append((Reading(candidate.program, folding, "", min(1.0, sure)), math.exp(candidate.score)))
    readings.sort(key=lambda found: -found[0].sure)
    # Whatever *either half* allows is a little surer than that itself, by the little that speaks for it alone.
    as_sure = [found for found in readings if found[0].sure > readings[0][0].sure - _AS_SURE]
    first = max(as_sure, key=lambda found: found[1])
    return [first[0], *(found[0] for found in readings if found is not first)]


_AS_SURE = 0.05
"""Readings whose sureness differs by less are as sure as each other: the likelier one by itself is taken."""


def _in_known_words(sentence: str, garment: Garment) -> str:
    """The sentence in words that the reader has learned.

    A kind of garment that it does not know is called as the family that it is of; parts that only the garment's
    template names become the edge that they lie on.
    """
    if garment.kind not in FAMILIES:
        own = re.escape(garment.kind).replace("_", "[ _-]?")
        sentence = re.sub(rf"\b(?:pair of )?{own}s?\b", FAMILY_WORDS[garment.family], sentence, flags=re.IGNORECASE)
    if garment.family != "other":
        return sentence
    for part in sorted(garment.parts, key=len, reverse=True):
        sentence = re.sub(rf"\b{re.escape(part)}\b", f"{garment.parts[part]} edge", sentence, flags=re.IGNORECASE)
    return sentence
