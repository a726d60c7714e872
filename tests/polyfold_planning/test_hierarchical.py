"""The hierarchical planner with scripted language models: repair, refusal, and what it accepts."""

from __future__ import annotations

import json

import numpy as np
import pytest
from polyfold_planning.answers.grammar import check_subgoal
from polyfold_planning.planners.hierarchical import HierarchicalPlanner

from experiments.benchmarks.language.understanding import laid_garment
from polyfold.errors import PlanError, RefusedError
from polyfold.geometry import FoldLine
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create
from polyfold.rollout._transcript import Transcript
from polyfold.types import Reply, Scene, Subgoal


class Scripted:
    """Gives the answers it was made with, one after the other."""

    def __init__(self, *answers: object) -> None:
        self.answers = list(answers)

    def complete(self, messages, params):
        answer = self.answers.pop(0)
        return answer if isinstance(answer, Reply) else Reply(f"So:\n```json\n{json.dumps(answer)}\n```")


def scene(kind: str = "square") -> Scene:
    laid = laid_garment(kind, 2003)
    outline = laid.model.outline()
    mask = fill_polygon(outline, 400, 400)
    return Scene(kind, laid.size, mask, outline, laid.model, laid.model.to_text(laid.size))


def line(x0, y0, x1, y1) -> dict:
    return {"fold_line": {"start": {"x": x0, "y": y0}, "end": {"x": x1, "y": y1}}}


GOOD = line(200, 60, 200, 340)
SUBGOAL = Subgoal("fold the right edge leftward to the left edge")


def plan(*answers, **config):
    conversation = Transcript(Scripted(*answers))
    planner = HierarchicalPlanner(HierarchicalPlanner.Config(**config))
    return planner.plan(SUBGOAL, scene(), conversation), conversation


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (line(200, 60, 200, 500), "outside"),
        (line(200, 200, 204, 204), "px long"),
        (line(2, 2, 2, 390), "no cloth to the"),
        ({"fold_line": None}, "the form"),
        (Reply("I can't do JSON"), "no fenced"),
    ],
)
def test_an_invalid_line_goes_back_with_the_reason(bad, words):
    found, conversation = plan(bad, GOOD)
    assert found.start == (200.0, 60.0)
    assert words in conversation.calls[1].messages[-1]["content"]
    assert conversation.calls[1].messages[-2]["role"] == "assistant"
    assert [call.attempt for call in conversation.calls] == [1, 2]


def test_three_invalid_answers_end_it():
    bad = line(2, 2, 2, 390)
    with pytest.raises(PlanError, match="after 3 attempts"):
        plan(bad, bad, bad, GOOD)


def test_max_attempts_is_a_parameter():
    with pytest.raises(PlanError, match="after 1 attempts"):
        plan(line(2, 2, 2, 390), GOOD, max_attempts=1)


def test_a_refusal_is_final():
    with pytest.raises(RefusedError, match="no such part"):
        plan({"refused": "no such part"}, GOOD)


def test_a_line_without_model_is_checked_against_the_mask():
    bare = scene()
    bare = Scene(bare.kind, bare.image_size, bare.mask, bare.contour, None, bare.text)
    found = HierarchicalPlanner().plan(SUBGOAL, bare, Transcript(Scripted(line(1, 1, 1, 300), GOOD)))
    assert np.isfinite(found.length)


def test_subgoals_outside_the_grammar_go_back():
    template = create("garments", "square").template()
    answers = [
        {"subgoals": ["crumple it"]},
        {"subgoals": ["fold the left sleeve to the centre"]},
        {"subgoals": ["fold the top left corner to the centre"]},
    ]
    conversation = Transcript(Scripted(*answers))
    found = HierarchicalPlanner().subgoals("corner to the centre", template, conversation)
    assert [subgoal.text for subgoal in found] == ["fold the top left corner to the centre"]
    assert "does not have the form" in conversation.calls[1].messages[-1]["content"]
    assert "left sleeve" in conversation.calls[2].messages[-1]["content"]


def test_parameters_reach_the_model_over_the_prompts_own():
    _, conversation = plan(GOOD, params={"temperature": 0.7})
    assert conversation.calls[0].params["temperature"] == 0.7
    assert "max_tokens" in conversation.calls[0].params


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("tshirt", "fold the left sleeve inward to the body along the armhole"),
        ("tshirt", "Fold hem_left upward to shoulder_left."),
        ("pants", "fold the leg ends up to the waist"),
        ("square", "fold the bottom left and top right corners inward to the centre of the cloth"),
        ("rectangle", "fold the left half over onto the right half along the gap"),
    ],
)
def test_the_grammar_takes_anchored_subgoals(kind, text):
    check_subgoal(text, create("garments", kind).template())


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("tshirt", "bring the hem up"),
        ("tshirt", "fold the hood to the body"),
        ("pants", "fold the left sleeve to the waist"),
        ("square", "fold the top left corner to the moon"),
        ("square", "fold"),
    ],
)
def test_the_grammar_refuses_others(kind, text):
    with pytest.raises(PlanError):
        check_subgoal(text, create("garments", kind).template())


def test_a_line_that_lifts_the_wrong_side_goes_back():
    found, conversation = plan(line(200, 340, 200, 60), GOOD)
    assert found.start == (200.0, 60.0)
    assert "on the side that stays" in conversation.calls[1].messages[-1]["content"]


def test_what_was_done_is_told_and_can_be_said_to_have_come_open():
    first, second = Subgoal("fold the left edge to the middle line"), SUBGOAL
    left = line(150, 340, 150, 60)
    conversation = Transcript(Scripted(left, {"undone": "fold the sky"}, {"undone": first.text}, left, GOOD))
    planner = HierarchicalPlanner()
    assert isinstance(planner.plan(first, scene("rectangle"), conversation), FoldLine)
    assert planner.plan(second, scene("rectangle"), conversation) == first
    assert "has not been done" in conversation.calls[2].messages[-1]["content"]
    planner.plan(first, scene("rectangle"), conversation)
    planner.plan(second, scene("rectangle"), conversation)
    asked = [call.messages[-1]["content"] for call in conversation.calls]
    told = f'Done so far: ["{first.text}"]'
    assert [told in text for text in (asked[0], asked[1], asked[3], asked[4])] == [False, True, False, True]
