"""What training adds to sentences: it changes no meaning, or changes it as it says."""

from __future__ import annotations

import re
from random import Random

import pytest
from polyfold_offline.meaning.program import parse_program
from polyfold_offline.training.asides import with_aside
from polyfold_offline.training.corpus import Example
from polyfold_offline.training.generator import generate

ONE_FOLD = re.compile(r"\b(one|a|1)( single)? (fold|move)s?\b|fold only once|fold once", re.IGNORECASE)
PLACES = {
    "BL": r"(bottom|lower)[ -]left|left bottom", "TL": r"(top|upper)[ -]left|left top",
    "TR": r"(top|upper)[ -]right|right top", "BR": r"(bottom|lower)[ -]right|right bottom",
}  # fmt: skip


def told(code: str, family: str = "square", text: str = "WISH") -> set[tuple[str, str]]:
    """What is added to a wish, with the meaning of the whole, over many draws."""
    random, found = Random(0), set()
    for _ in range(400):
        more = with_aside(Example(family, text, parse_program(code)[0], "x"), random)
        assert text.lower() in more.text.lower()
        found.add((more.text.lower().replace(text.lower(), ""), "; ".join(map(str, more.program))))
    return found


@pytest.mark.parametrize(
    "code", ["half L", "mid T", "across BL", "half L; half B", "goal neat", "no part", "sleeve L any"]
)
def test_only_what_needs_more_folds_than_are_allowed_becomes_a_contradiction(code):
    family = "tshirt" if "sleeve" in code else "square"
    for aside, meaning in told(code, family):
        if code == "half L; half B" and ONE_FOLD.search(aside):
            assert meaning == "no contradiction", aside
        elif code != "half L; half B":
            assert meaning == code, aside


def test_what_is_said_to_stay_is_none_of_what_moves():
    for code, moves in (
        ("half L", "left.(edge|side|hand|border)|on the left"),
        ("half B", "(bottom|lower).(edge|side|border)"),
        ("mid R", "right.(edge|side|hand|border)|on the right"),
        ("across TR", "(top|upper).right"),
    ):
        asides = {aside for aside, _ in told(code)}
        assert not [aside for aside in asides if re.search(rf"\b({moves})\b", aside)]
    assert any("right" in aside for aside, _ in told("half L"))
    assert any("left sleeve" in aside for aside, _ in told("sleeve R any; half B", "tshirt"))
    assert not any("sleeve" in aside for aside, _ in told("sleeve R any; half L", "tshirt"))


def test_nothing_is_added_to_a_refusal():
    assert told("no action") == {("", "no action")}


def test_lists_of_corners_are_told_in_their_order_or_numbered():
    checked = 0
    for example in generate(4000, 1):
        places = [piece.place for piece in example.program]
        text = example.text.lower()
        at = {place: match.start() for place, name in PLACES.items() if (match := re.search(name, text))}
        if {piece.operation for piece in example.program} != {"centre"} or len(places) < 2 or at.keys() != set(places):
            continue
        if not re.search(r"first|last|before|second|prior|once|end with|to finish", text):
            assert sorted(places, key=at.__getitem__) == places, example.text
            checked += 1
    assert checked > 20
