"""What programs can be said, and that spelling and reading them are each other's inverse."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_offline.meaning.program import MAX_PIECES, parse_program
from polyfold_offline.reading.tokens import FAMILIES, MAX_TOKENS, TOKENS, advance, begin, choices, spell
from polyfold_offline.training.corpus import read_corpus

SENTENCES = Path(__file__).parents[2] / "experiments" / "language" / "sentences"


@st.composite
def programs(draw):
    state = begin(draw(st.sampled_from(FAMILIES)))
    while not state.ended:
        state = advance(state, draw(st.sampled_from(choices(state))))
    return state.family, state.pieces


@settings(max_examples=300, deadline=None)
@given(programs())
def test_what_is_spelled_is_read_again(said):
    family, program = said
    told = spell(program, family)
    assert len(told) <= MAX_TOKENS
    assert len(program) <= MAX_PIECES
    state = begin(family)
    for token, allowed in told:
        assert token in allowed
        assert len(allowed) > 1
        state = advance(state, token)
    assert (state.ended, state.pieces) == (True, program)


@pytest.mark.parametrize(
    ("family", "code"),
    [("pants", "centre BL"), ("square", "sleeve L any"), ("tshirt", "across TL"), ("square", "half long"),
     ("rectangle", "goal sleeveless"), ("square", "no action; half L")],
)  # fmt: skip
def test_a_garment_allows_only_what_it_has(family, code):
    with pytest.raises(ValueError, match=r"can't be said|nothing can follow"):
        spell(parse_program(code)[0], family)


@pytest.mark.parametrize("code", ["", "fold L", "half X", "strip B", "sleeve L", "goal", "goal cake", "strip B 7/9"])
def test_what_is_no_code_is_refused(code):
    with pytest.raises((ValueError, IndexError)):
        parse_program(code)


def test_lengths_are_numbered_in_the_order_of_the_code():
    program, lengths = parse_program("strip B 5cm; strip T 7.5cm")
    assert ([piece.detail for piece in program], lengths) == (["#1", "#2"], (5.0, 7.5))
    program, lengths = parse_program("goal neat in 3 fit 20x30")
    assert (program[0].detail, program[1].place, program[1].detail, lengths) == ("3", "#1", "#2", (20.0, 30.0))


def test_every_token_has_a_name_of_its_own():
    assert len(set(TOKENS)) == len(TOKENS)


@pytest.mark.parametrize("use", sorted(path.name for path in SENTENCES.iterdir() if path.is_dir()))
def test_every_written_meaning_can_be_spelled(use):
    examples = read_corpus(SENTENCES / use)
    for example in examples:
        assert spell(example.program, example.family)
    assert len({(e.family, e.text, e.register) for e in examples}) > 0.99 * len(examples)
