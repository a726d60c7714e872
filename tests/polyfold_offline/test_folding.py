"""Programs to folds: what is left open is settled as the prompt says, what can't be is refused."""

from __future__ import annotations

import contextlib
from fractions import Fraction

import pytest
from polyfold_offline.cloth.folds import CORNERS, EDGES, OPPOSITE_CORNER, Fold, say
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.meaning.allowing import allowance
from polyfold_offline.meaning.folding import folds_of
from polyfold_offline.meaning.program import parse_program
from polyfold_offline.reading.orders import fold_of_subgoal
from polyfold_offline.training.generator import generate
from polyfold_planning.answers.grammar import check_subgoal

from polyfold.plugins import create

SIZES = {"square": (50.0, 50.0), "rectangle": (50.0, 70.0), "tshirt": (60.0, 66.0), "pants": (40.0, 90.0)}


def garment(kind: str) -> Garment:
    return Garment(kind, kind, {}, SIZES.get(kind))


def folded(kind: str, code: str) -> list[Fold]:
    return folds_of(*parse_program(code), garment(kind)).folds


@pytest.mark.parametrize(
    ("kind", "code", "folds"),
    [
        ("square", "half any", [Fold("half", "bottom")]),
        ("tshirt", "half any", [Fold("half", "left")]),
        ("pants", "half any; half any", [Fold("half", "left"), Fold("half", "bottom")]),
        ("square", "half side; half any", [Fold("half", "left"), Fold("half", "bottom")]),
        ("rectangle", "half B; half any; half any",
         [Fold("half", "bottom"), Fold("half", "left"), Fold("half", "bottom", manner="again")]),
        ("rectangle", "mid L; mid R; half any",
         [Fold("middle", "left"), Fold("middle", "right"), Fold("half", "left", manner="gap")]),
        ("rectangle", "mid T; mid B; half T",
         [Fold("middle", "top"), Fold("middle", "bottom"), Fold("half", "top", manner="gap")]),
        ("square", "across TL; half any",
         [Fold("corner", "top_left", "bottom_right"), Fold("corner", "bottom_left", "top_right")]),
        ("square", "centre any; centre any",
         [Fold("corner", "bottom_left", "centre"), Fold("corner", "top_left", "centre")]),
        ("tshirt", "sleeve any slanted; sleeve any any",
         [Fold("sleeve", "left", manner="slanted"), Fold("sleeve", "right", manner="slanted")]),
        ("tshirt", "sleeve L any; sleeve R any; half any",
         [Fold("sleeve", "left", manner="straight"), Fold("sleeve", "right", manner="straight"),
          Fold("half", "bottom")]),
        ("pants", "half L; strip B 5cm", [Fold("half", "left"), Fold("band", "bottom", cm=5.0)]),
        ("square", "strip L 1/4", [Fold("band", "left", share=Fraction(1, 4))]),
    ],
)  # fmt: skip
def test_steps_become_folds(kind, code, folds):
    assert folded(kind, code) == folds


@pytest.mark.parametrize(
    ("kind", "code", "words"),
    [
        ("square", "no action", "only fold"),
        ("tshirt", "no garment", "t-shirt on the table"),
        ("pants", "no part", "pair of pants does not have"),
        ("square", "half L; half R", "say which"),
        ("tshirt", "sleeve L any; sleeve L any", "same fold twice"),
        ("square", "centre BL; centre BL", "same fold twice"),
        ("square", "strip B 80cm", "80 cm is wider"),
        ("square", "strip B 0cm", "no width"),
        ("square", "half L; half B; half L; half B; half L", "too thick"),
        ("tshirt", "goal neat fit 5x5", "5 x 5 cm"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_reason(kind, code, words):
    with pytest.raises(NotUnderstoodError, match=words):
        folded(kind, code)


@pytest.mark.parametrize(
    ("kind", "code", "count"),
    [
        ("square", "goal triangle", 1), ("square", "goal small-triangle", 2), ("square", "goal envelope", 4),
        ("square", "goal quarter", 2), ("rectangle", "goal gate", 2), ("rectangle", "goal letter", 2),
        ("rectangle", "goal square", 1), ("tshirt", "goal neat", 3), ("tshirt", "goal sleeveless", 2),
        ("pants", "goal shorts", 1), ("pants", "goal one-leg", 1), ("pants", "goal neat", 3),
        ("square", "goal point T", 2), ("rectangle", "goal neat in 3", 3), ("square", "goal eighth", 3),
        ("square", "goal square", 2), ("rectangle", "goal sixth", 3), ("square", "goal sixteenth", 4),
        ("rectangle", "goal three-quarters", 1), ("pants", "goal sixth", 3), ("square", "goal tiny", 4),
        ("tshirt", "goal tiny", 5), ("square", "goal strip", 2),
    ],
)  # fmt: skip
def test_goals_take_the_fewest_folds_that_reach_them(kind, code, count):
    assert len(folded(kind, code)) == count


def test_what_must_fit_is_folded_until_it_does():
    assert len(folded("rectangle", "goal neat fit 60x40")) < len(folded("rectangle", "goal neat fit 30x20"))


def test_a_size_is_unknown_without_the_garments_own():
    with pytest.raises(NotUnderstoodError, match="how large"):
        folds_of(*parse_program("goal neat fit 20x30"), Garment("square", "square"))


def sayable(kind: str) -> list[Fold]:
    folds = [Fold("half", edge) for edge in EDGES]
    folds += [Fold("half", edge, manner="gap") for edge in EDGES]
    folds += [Fold("band", edge, share=Fraction(share)) for edge in EDGES for share in ("1/3", "1/4", "1/5", "2/3")]
    folds += [Fold("band", edge, cm=4.5) for edge in EDGES]
    if kind in ("square", "rectangle"):
        folds += [Fold("middle", edge) for edge in EDGES]
        folds += [Fold("corner", corner, "centre") for corner in CORNERS]
        folds += [Fold("corner", corner, opposite) for corner, opposite in OPPOSITE_CORNER.items()]
    if kind == "tshirt":
        folds += [Fold("sleeve", side, manner=m) for side in ("left", "right") for m in ("straight", "slanted")]
    return folds


@pytest.mark.parametrize("kind", SIZES)
def test_every_subgoal_is_anchored_and_means_what_it_says(kind):
    template = create("garments", kind).template()
    for fold in sayable(kind):
        text = say(fold, kind)
        check_subgoal(text, template)
        assert fold_of_subgoal(text, garment(kind)) == fold


@pytest.mark.parametrize("share", ["third", "quarter"])
def test_a_shirt_of_a_wished_size_ends_as_a_rectangle(share):
    actions = [fold.action for fold in folded("tshirt", f"goal {share}")]
    assert actions[:2] == ["sleeve", "sleeve"], "a shirt halved twice is as small, and ragged"


@pytest.mark.parametrize(
    ("kind", "meant", "done", "how_far"),
    [
        ("square", "half any", "half T", 1.0),
        ("square", "half end", "half T", 1.0),
        ("square", "half end", "half L", 0.0),
        ("square", "half T", "half any", 0.0),
        ("rectangle", "half L; half end", "half L; half T", 1.0),
        ("rectangle", "half L; half end", "half T", 0.0),
        ("square", "across any; half any", "across TR; half any", 1.0),
        ("tshirt", "sleeve any any", "sleeve R slanted", 1.0),
        ("tshirt", "sleeve L straight", "sleeve L slanted", 0.0),
        ("square", "goal triangle", "across BL", 1.0),
        ("square", "goal triangle", "across BR", 0.9),
        ("square", "goal triangle", "across BR; half any", 0.5),
        ("square", "goal half", "half any", 1.0),
        ("square", "goal half", "half R", 0.9),
        ("pants", "goal one-leg", "half any", 1.0),
        ("pants", "goal one-leg", "half R", 0.9),
        ("pants", "goal one-leg", "half B", 0.0),
        ("square", "goal neat in 2", "half B; half L", 1.0),
        ("square", "goal neat in 2", "half L; half B", 0.9),
        ("square", "no action", "half B", 0.0),
    ],
)
def test_what_a_meaning_leaves_open_may_be_done_in_any_way(kind, meant, done, how_far):
    program, lengths = parse_program(meant)
    assert allowance(program, lengths, garment(kind), folded(kind, done)) == how_far


@pytest.mark.parametrize("kind", sorted(SIZES))
def test_every_meaning_allows_the_folds_that_are_made_of_it(kind):
    made = 0
    for example in generate(600, 1):
        if example.family == kind:
            with contextlib.suppress(NotUnderstoodError):
                folds = folds_of(example.program, (10, 8, 6, 4), garment(kind)).folds
                assert allowance(example.program, (10, 8, 6, 4), garment(kind), folds) == 1.0, example.program
                made += 1
    assert made > 40


def test_a_share_that_has_no_name_is_so_much_of_the_side_and_asks_for_centimetres_where_that_is_unknown():
    program, _ = parse_program("strip R 5cm")
    known = Garment("rectangle", "rectangle", {}, (50.0, 70.0))
    (fold,) = folds_of(program, [Fraction(1, 10)], known).folds
    assert (fold.part, fold.cm) == ("right", 5.0)
    (fold,) = folds_of(parse_program("strip T 5cm")[0], [Fraction(1, 10)], known).folds
    assert (fold.part, fold.cm) == ("top", 7.0)
    with pytest.raises(NotUnderstoodError, match="1/10 of it is; say it in centimetres"):
        folds_of(program, [Fraction(1, 10)], Garment("rectangle", "rectangle"))


@pytest.mark.parametrize("kind", ["square", "rectangle", "tshirt", "pants"])
@pytest.mark.parametrize("edge", ["L", "R", "T", "B"])
def test_a_half_that_is_halved_again_the_same_way_is_said_in_other_words_than_the_first(kind, edge):
    first, second = folds_of(parse_program(f"half {edge}; half {edge}")[0], (), garment(kind)).folds
    assert first.part == second.part
    said = [say(fold, kind) for fold in (first, second)]
    assert said[0] != said[1]
    assert [fold_of_subgoal(text, garment(kind)) for text in said] == [first, second]
    for text in said:
        check_subgoal(text, create("garments", kind).template())
