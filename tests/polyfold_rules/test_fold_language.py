"""The grammar and geometry of the rules model, seen from outside: messages in, fold lines out."""

from __future__ import annotations

import contextlib
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_planning.answers.grammar import check_subgoal
from polyfold_rules.clauses.meaning import understand
from polyfold_rules.shapes.folds import CORNERS, EDGES, OPPOSITE_CORNER, Fold, say
from polyfold_rules.shapes.parts import Garment, NotUnderstoodError
from polyfold_rules.wishes.instruction import plan

from experiments.benchmarks.language.understanding import accepted, judge_set, laid_garment, part_of_set, plan_ideally
from polyfold.errors import RefusedError
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create, find
from polyfold.prompts import load_prompt
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import OpenTask, load_suite
from polyfold.tasks._goals import measure

FAMILIES = {"square": "quad", "rectangle": "quad", "tshirt": "tshirt", "pants": "pants"}
CONTENT = tomllib.loads((Path(__file__).parent / "phrasings.toml").read_text("utf-8"))


@pytest.fixture(scope="module")
def planner():
    return create("planners", "hierarchical")


@pytest.fixture(scope="module")
def rules():
    return create("llms", "rules")


@pytest.fixture(scope="module")
def suite():
    return load_suite(str(find("tasks", "polyfold70").target))


def every_fold(kind: str) -> list[Fold]:
    folds = [Fold("half", edge) for edge in EDGES]
    folds += [Fold("half", edge, manner="gap") for edge in EDGES]
    folds += [Fold("band", edge, share=share) for edge in EDGES for share in (1 / 3, 0.25)]
    if kind in ("square", "rectangle"):
        folds += [Fold("middle", edge) for edge in EDGES]
        folds += [Fold("corner", corner, "centre") for corner in CORNERS]
        folds += [Fold("corner", corner, opposite) for corner, opposite in OPPOSITE_CORNER.items()]
    if kind == "tshirt":
        folds += [Fold("sleeve", side, manner=m) for side in ("left", "right") for m in ("straight", "slanted")]
    return folds


@pytest.mark.parametrize("kind", FAMILIES)
def test_every_subgoal_is_anchored_and_means_what_it_says(kind):
    template = create("garments", kind).template()
    for fold in every_fold(kind):
        text = say(fold, kind)
        check_subgoal(text, template)
        (again,) = understand(text, Garment(kind, FAMILIES[kind])).folds
        assert (again.action, again.part, again.target, again.share) == (
            fold.action,
            fold.part,
            fold.target,
            fold.share,
        )
        assert fold.action != "sleeve" or again.manner == fold.manner


def test_known_instructions_are_planned_as_meant_and_the_others_refused(planner, rules, suite):
    outcomes = judge_set(CONTENT, suite, planner, rules)
    wrong = [o for o in outcomes if o.result != ("as intended" if o.expected else "refused")]
    assert not wrong, "\n".join(f"{o.garment}: {o.text!r} -> {o.result} ({o.detail})" for o in wrong)
    assert len(outcomes) > 300


def test_instructions_of_another_hand_are_understood_nearly_always(planner, rules, suite):
    """A set written without sight of the grammar; its first run scored 71.0 % of 214, and 45 of 46 refusals."""
    path = Path(__file__).parent / "instructions.toml"
    outcomes = judge_set(tomllib.loads(path.read_text("utf-8")), suite, planner, rules)
    meant = [outcome for outcome in outcomes if outcome.expected]
    assert sum(outcome.result == "as intended" for outcome in meant) >= 0.95 * len(meant)
    assert all(outcome.result == "refused" for outcome in outcomes if not outcome.expected)


def test_developed_manners_of_speaking_are_understood_and_seldom_mistaken(planner, rules, suite):
    """The developed part; before the grammar was widened on it, it scored 57.7 % of 234, and 6.0 % other folds."""
    content = tomllib.loads((Path(__file__).parent / "sentences.toml").read_text("utf-8"))
    outcomes = judge_set(part_of_set(content, held_out=False), suite, planner, rules)
    meant = [outcome.result for outcome in outcomes if outcome.expected]
    assert meant.count("as intended") >= 0.85 * len(meant)
    assert meant.count("other folds") <= 0.03 * len(meant)


def test_the_language_of_geometry_is_understood(planner, rules, suite):
    """Its first run scored 61 of 100 before the grammar was widened on it, with 9 other folds."""
    content = tomllib.loads((Path(__file__).parent / "formal.toml").read_text("utf-8"))
    outcomes = judge_set(content, suite, planner, rules)
    missed = [o.text for o in outcomes if o.result != ("as intended" if o.expected else "refused")]
    assert len(missed) <= 3, missed
    assert not [o.text for o in outcomes if o.result == "other folds"]


def silhouette(model, size: tuple[int, int]) -> np.ndarray:
    pieces = [fill_polygon(facet.polygon, size[1], size[0]) for facet in model.facets()]
    return np.any(pieces, axis=0)


def reaches(goal: OpenTask, planner, rules, suite) -> bool:
    laid = laid_garment(goal.garment, 2001)
    try:
        lines = plan_ideally(goal.text, laid, planner, rules)
    except RefusedError:
        return False
    if goal.accept and accepted(laid, lines, goal.accept, suite, unordered=False):
        return True
    end = laid.model
    for line in lines:
        end = end.fold(line)
    measured = measure(silhouette(end, laid.size), silhouette(laid.model, laid.size), len(lines))
    return goal.done is not None and not goal.done.failing(measured)


def test_developed_goals_are_nearly_all_reached(planner, rules, suite):
    """Goals without a way; before ends were compared, 23 of the first 90 were reached."""
    content = tomllib.loads((Path(__file__).parent / "goals.toml").read_text("utf-8"))
    missed = [goal["id"] for goal in content["goal"] if not reaches(OpenTask(**goal), planner, rules, suite)]
    assert len(missed) <= 0.1 * len(content["goal"]), missed


@pytest.mark.parametrize(
    ("kind", "text", "folds"),
    [
        ("square", "Would you be so kind as to bring the BL corner to the centre?",
         [Fold("corner", "bottom_left", "centre")]),
        ("square", "Whoosh, plunk the top left corner onto the bottom right one.",
         [Fold("corner", "top_left", "bottom_right")]),
        ("rectangle", "With the left half folded onto the right one already, fold the top down to the bottom.",
         [Fold("half", "left"), Fold("half", "top")]),
        ("rectangle", "A quarter of the area: first left over right, then bottom over top.",
         [Fold("half", "left"), Fold("half", "bottom")]),
        ("tshirt", "Right sleeve in, neck to armpit.", [Fold("sleeve", "right", manner="slanted")]),
        ("tshirt", "Take the hem, lift it up, and finally put it on the shoulders.", [Fold("half", "bottom")]),
        ("pants", "I need them half as wide for my trip.", [Fold("half", "left")]),
        ("square", "A triangle for the picnic, a quarter of the size.",
         [Fold("corner", "bottom_left", "top_right"), Fold("corner", "top_left", "bottom_right")]),
    ],
)  # fmt: skip
def test_wording_makes_no_difference(kind, text, folds):
    assert list(plan(text, Garment(kind, FAMILIES[kind])).folds) == folds


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        ("square", "Make it a third of its size and triangular.", "triangle"),
        ("tshirt", "An eighth of the area in one fold.", "no way"),
        ("square", "Turn it into a swan.", "swan"),
        ("square", "Put the cloth in the drawer.", "carry|do not understand|else"),
        ("tshirt", "Glue the left sleeve to the body.", "glue"),
    ],
)
def test_wishes_that_nothing_grants_are_refused(kind, text, words):
    with pytest.raises(NotUnderstoodError, match=words):
        plan(text, Garment(kind, FAMILIES[kind]))


@settings(max_examples=12, deadline=None)
@given(angle=st.floats(-180, 180), seed=st.integers(2000, 2010))
def test_fold_lines_turn_with_the_garment(angle, seed):
    planner, rules = create("planners", "hierarchical"), create("llms", "rules")
    suite = load_suite(str(find("tasks", "polyfold70").target))
    laid = laid_garment("tshirt", seed)
    centre = (np.array(laid.size) - 1) / 2
    model = laid.model.transformed(np.radians(angle), centre=centre)
    particles = laid.model.transformed(0.0).rest
    turned = type(laid)(model, model.rest, laid.size)
    assert particles.shape == model.rest.shape
    lines = plan_ideally("fold both sleeves straight in, then the hem up to the shoulders", turned, planner, rules)
    assert accepted(turned, lines, ["tshirt-block-left-first"], suite, unordered=False)


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        ("square", "fold the left sleeve", "no sleeve"),
        ("tshirt", "fold the trousers in half", "pants"),
        ("tshirt", "iron the shirt", "iron"),
        ("square", "fold it forty times", "40"),
        ("square", "", "no folding instruction"),
        ("tshirt", "fold the flumbet to the body", "flumbet"),
        ("rectangle", "fold the bottom edge down", "off the cloth"),
    ],
)
def test_refusals_say_what_was_not_understood(planner, rules, kind, text, words):
    with pytest.raises(RefusedError, match=words):
        plan_ideally(text, laid_garment(kind, 2001), planner, rules)


@settings(max_examples=60, deadline=None)
@given(st.text(max_size=80))
def test_no_text_breaks_the_parser(text):
    planner, rules = create("planners", "hierarchical"), create("llms", "rules")
    template = create("garments", "tshirt").template()
    with contextlib.suppress(RefusedError):
        assert planner.subgoals(text, template, Transcript(rules))


WORDS = [
    "fold", "bring", "the", "left", "right", "top", "bottom", "sleeve", "sleeves", "corner", "edge", "half",
    "middle", "to", "onto", "over", "then", "and", "not", "it", "in", "again", "both", "other", "hem", "waist", "leg",
    "legs", "triangle", "so", "that", "meets", "from", "along", "diagonal", "first", "one", "two", "three",
    "except", "only", "up", "down", ",", ".",
]  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(sorted(FAMILIES)), st.lists(st.sampled_from(WORDS), min_size=1, max_size=14))
def test_no_word_salad_breaks_the_parser(kind, words):
    template = create("garments", kind).template()
    with contextlib.suppress(NotUnderstoodError):
        meaning = understand(" ".join(words), Garment(kind, FAMILIES[kind]))
        for fold in meaning.folds:
            check_subgoal(say(fold, kind), template)


def test_misspellings_are_read_and_mentioned():
    meaning = understand("fold the left sleeev in", Garment("tshirt", "tshirt"))
    assert meaning.folds == (Fold("sleeve", "left", manner="straight"),)
    assert any("sleeev" in note for note in meaning.notes)


def test_anonymous_vertices_are_enough_for_halves_but_not_for_sleeves(rules):
    corners = [(100, 100), (300, 100), (300, 300), (100, 300)]
    model = {
        "garment": "tshirt",
        "image": {"width": 400, "height": 400},
        "vertices": {f"p{i}": [x, y] for i, (x, y) in enumerate(corners)},
    }
    prompt = load_prompt("fold_line")
    half = rules.complete(prompt.render(model=model, done=[], subgoal="fold the left side to the right side"), {})
    assert '"fold_line"' in half.text
    sleeve = rules.complete(prompt.render(model=model, done=[], subgoal="fold the left sleeve inward to the body"), {})
    assert '"refused"' in sleeve.text
