"""Planners without fold lines, with scripted language models: what they accept, ask again, and show."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from test_hierarchical import Scripted, scene

import polyfold
from polyfold import plugins
from polyfold.errors import ConfigError, PlanError, RefusedError
from polyfold.plugins import create
from polyfold.rollout._transcript import Transcript
from polyfold.types import Subgoal

SUBGOAL = Subgoal("fold the right edge leftward to the left edge")


def motion(picks, places) -> dict:
    return {what: [{"x": x, "y": y} for x, y in points] for what, points in (("picks", picks), ("places", places))}


ONE = motion([(200, 200)], [(120, 200)])
TWO = motion([(200, 180), (200, 220)], [(120, 180), (120, 220)])
PICTURE = np.full((400, 400, 3), 90, np.uint8)


def plan(planner, *answers, on=None, **config):
    conversation = Transcript(Scripted(*answers))
    found = create("planners", planner, config).plan(SUBGOAL, on or scene(), conversation)
    return found, conversation


def asked(conversation, entry=0) -> str:
    return str(conversation.calls[entry].messages[-1]["content"])


def test_picks_and_places_become_an_action():
    one, conversation = plan("direct-1arm", ONE)
    assert (one.picks.tolist(), one.places.tolist()) == ([[200.0, 200.0]], [[120.0, 200.0]])
    assert conversation.calls[0].role == "direct_1arm"
    assert plan("direct-2arm", TWO)[0].arms == 2
    assert plan("direct-2arm", ONE)[0].arms == 1


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (TWO, "give 1"),
        ({"picks": ONE["picks"]}, "places"),
        (motion([(200, 200)], [(120, 900)]), "outside"),
        (motion([(3, 3)], [(120, 200)]), "nearest cloth"),
        (motion([(200, 200)], [(202, 200)]), "nothing would move"),
        (motion([(200, 200)], [("a", 200)]), "finite number"),
        ({"fold_line": {}}, "the form"),
    ],
)
def test_an_unusable_motion_goes_back_with_the_reason(bad, words):
    found, conversation = plan("direct-1arm", bad, ONE)
    assert found.arms == 1
    assert words in asked(conversation, 1)


def test_grippers_that_would_collide_go_back():
    together = motion([(200, 200), (202, 200)], [(120, 200), (122, 200)])
    _, conversation = plan("direct-2arm", together, TWO)
    assert "use one arm" in asked(conversation, 1)


def test_three_unusable_motions_end_it_and_a_refusal_is_final():
    with pytest.raises(PlanError, match="after 3 attempts"):
        plan("direct-1arm", TWO, TWO, TWO)
    with pytest.raises(RefusedError, match="no such part"):
        plan("direct-2arm", {"refused": "no such part"})


def test_the_prompt_explains_what_the_scene_shows():
    text = json.dumps({"garment": "square", "image": {"width": 400, "height": 400}, "keypoints": [[1, 2], [3, 4]]})
    points = replace(scene(), text=text, shown=("keypoints",))
    _, conversation = plan("direct-2arm", TWO, on=points)
    assert "points without names" in conversation.calls[0].messages[0]["content"]
    with pytest.raises(ConfigError, match="image-v2"):
        plan("direct-2arm", TWO, on=replace(scene(), picture=PICTURE, shown=("image",)))


@pytest.mark.parametrize("words", [(), ("keypoints",), ("polygon",)])
def test_fold_lines_are_asked_for_with_the_picture_beside_the_words(words):
    on = replace(scene(), picture=PICTURE, shown=(*words, "image"))
    answer = {"fold_line": {"start": {"x": 200, "y": 60}, "end": {"x": 200, "y": 340}}}
    llm = Scripted(answer)
    messages = []
    llm.complete, complete = lambda sent, params: messages.extend(sent) or complete(sent, params), llm.complete
    create("planners", "hierarchical").plan(SUBGOAL, on, Transcript(llm))
    text, image = messages[-1]["content"]
    assert on.text in text["text"]
    assert image["image_url"]["url"].startswith("data:image/png;base64,")
    assert "picture" in messages[0]["content"]


def test_a_prompt_with_a_picture_needs_a_scene_with_one():
    with pytest.raises(ConfigError, match="choose a grounding"):
        plan("zero-shot-vlm", ONE)


def test_the_zero_shot_planner_is_asked_until_it_is_done():
    planner, on = create("planners", "zero-shot-vlm"), replace(scene(), picture=PICTURE, shown=("image",))
    conversation = Transcript(Scripted(TWO, ONE, {"done": True}))
    (subgoal,) = planner.subgoals("make it small", create("garments", "square").template(), conversation)
    assert subgoal.text == "make it small"
    assert not conversation.calls
    found = [planner.plan(subgoal, on, conversation) for _ in range(3)]
    assert [action and action.arms for action in found] == [2, 1, None]
    assert "[200.0, 180.0]" in asked(conversation, 1)
    assert "[200.0, 180.0]" not in asked(conversation, 0)


def test_the_zero_shot_planner_stops_after_its_limit():
    planner = create("planners", "zero-shot-vlm", {"max_folds": 1})
    on, conversation = replace(scene(), picture=PICTURE), Transcript(Scripted(ONE, ONE))
    assert planner.plan(SUBGOAL, on, conversation) is not None
    assert planner.plan(SUBGOAL, on, conversation) is None


class Sighted(Scripted):
    """Two folds, then done."""

    def __init__(self) -> None:
        super().__init__(TWO, motion([(200, 200)], [(170, 170)]), {"done": True})


def test_an_episode_goes_on_until_the_zero_shot_planner_is_done():
    polyfold.register("llms", "sighted", Sighted, "a test's model")
    try:
        episode = polyfold.fold(
            "make it small",
            garment=polyfold.garment("square", seed=2001, edge_length=0.03),
            grounding="image",
            planner="zero-shot-vlm",
            llm="sighted",
            agent={"name": "polyfold", "recover": False},
        )
    finally:
        for kind, name in plugins.by_hand():
            plugins.unregister(kind, name)
    assert [step.action.arms for step in episode.steps] == [2, 1]
    assert [call.role for call in episode.calls] == ["zero_shot"] * 3
    assert episode.failure is None
