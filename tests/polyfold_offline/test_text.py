"""Lengths are taken out of sentences, and misspelt words come back to those of folding."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from polyfold_offline.reading.text import Corrector, take_lengths

WORDS = {
    "sleeve": 90, "corner": 80, "bottom": 70, "left": 60, "middle": 50, "towel": 40, "third": 30, "waist": 20,
    "diagonal": 10, "vertical": 10,
}  # fmt: skip
COMMON = {"leaf", "button", "lift", "cornet", "riddle", "the", "of", "fold"}


@pytest.mark.parametrize(
    ("sentence", "text", "lengths"),
    [
        ("turn in 5 cm at the left", "turn in #1 cm at the left", (5.0,)),
        ("turn in five centimetres, then 0.08 m", "turn in #1 cm, then #2 cm", (5.0, 8.0)),
        ("120mm of it", "#1 cm of it", (12.0,)),
        ("a 20 x 30 cm drawer", "a #1 by #2 cm drawer", (20.0, 30.0)),
        ("fits 25 by 35", "fits #1 by #2 cm", (25.0, 35.0)),
        ("twenty-five centimetres", "#1 cm", (25.0,)),
        ("a 3-inch strip", "a #1 cm strip", (7.62,)),
        ("eighty millimetres, then 75 milimeters", "#1 cm, then #2 cm", (8.0, 7.5)),
        ("fold 5 cm over on the left, hmm, make that 10.", "fold #1 cm over on the left.", (10.0,)),
        ("turn 6 cm up. Five, I meant to say", "turn #1 cm up", (5.0,)),
        ("4 cm at the hem. Not 4, 12!", "#1 cm at the hem!", (12.0,)),
        ("0.05 m along the top, no, sorry, 8 cm please", "#1 cm along the top please", (8.0,)),
        ("5 cm on the left, no, 10 cm on the right", "#1 cm on the left, no, #2 cm on the right", (5.0, 10.0)),
        ("5 cm at the top, then 10", "#1 cm at the top, then 10", (5.0,)),
        ("0.25 of the width, 20 % of it and 2/10", "1/4 of the width, 1/5 of it and 1/5", ()),
        ("half, 50 percent, 1/2", "half, half, half", ()),
        ("150% of the length", "#1 cm of the length", (1.5,)),
        ("I am 100 % sure", "I am 100 % sure", ()),
        ("a tenth of the width", "#1 cm of the width", (0.1,)),
        ("two sevenths, then 3 cm", "#2 cm, then #1 cm", (3.0, 2 / 7)),
        (
            "the tenth time, a ninth fold, in 10 % more 0.5 cm",
            "the tenth time, a ninth fold, in #2 cm more #1 cm",
            (0.5, 0.1),
        ),
        ("left one in, then the other one in", "left one in, then the other one in", ()),
        ("all four corners, 3/4 of it, in 2 folds", "all four corners, 3/4 of it, in 2 folds", ()),
    ],
)
def test_lengths_are_told_in_centimetres(sentence, text, lengths):
    read = take_lengths(sentence)
    assert " ".join(read.text.split()).replace(" ,", ",") == text
    assert read.lengths == pytest.approx(lengths)


@pytest.mark.parametrize(
    ("written", "meant"),
    [("sleave", "sleeve"), ("slev", "sleeve"), ("korner", "corner"), ("bottum", "bottom"), ("tpwel", "towel"),
     ("wayst", "waist"), ("therd", "third"), ("middel", "middle"), ("SLEEVEE", "sleeve"),
     ("diag", "diagonal"), ("vert", "vertical")],
)  # fmt: skip
def test_misspelt_words_are_brought_back(written, meant):
    assert Corrector(COMMON, WORDS).correct(f"the {written}, of the") == f"the {meant}, of the"


@pytest.mark.parametrize("word", ["leaf", "button", "cornet", "riddle", "xylophone", "ab", "Fold"])
def test_words_that_are_right_or_far_from_any_stay(word):
    assert Corrector(COMMON, WORDS).correct(word) == word


@given(st.text(max_size=200))
def test_any_text_can_be_prepared(text):
    read = take_lengths(text)
    Corrector(COMMON, WORDS).correct(read.text)
    assert all(length >= 0 for length in read.lengths)
