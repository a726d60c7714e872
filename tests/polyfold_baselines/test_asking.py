"""Agents that ask a language model: what it is told, what is done with its answers, what is sent back."""

import json

import cv2
import numpy as np
import pytest
from polyfold_baselines.agents.asking.gpt_fabric import seen
from polyfold_offline.loopback import Sent, completion, serve

import polyfold
from polyfold.api import attempt


class Model:
    """Answers each request by what ``replies`` makes of its last message; keeps the messages."""

    def __init__(self, *replies):
        self.replies, self.asked = list(replies), []

    def __call__(self, request):
        self.asked.append(request.body["messages"])
        reply = self.replies.pop(0) if len(self.replies) > 1 else self.replies[0]
        said = reply(self.asked[-1]) if callable(reply) else reply
        return Sent(completion(f"So.\n\n```json\n{json.dumps(said)}\n```"))


def folded(agent, model, kind, task, guidance="steps"):
    cloth = polyfold.garment(kind, seed=1001, edge_length=0.022)
    with serve(model) as server:
        llm = {"name": "litellm:openai/model", "api_base": server.address}
        experiment = polyfold.Experiment.of(agent=agent, llm=llm, guidance=guidance)
        return attempt("", cloth, 1001, experiment, task=task)


@pytest.fixture(autouse=True)
def key(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "sk-none")


def corner_to_corner(messages):
    told = messages[1]["content"]
    cloth = json.loads(told.partition("Cloth: ")[2].partition("\n")[0])
    corners, middle = np.array(cloth["corners"]), np.array(cloth["middle"])
    lowest = corners[np.argmin(corners @ [1, -1])]
    return {"pick": lowest.tolist(), "place": (2 * middle - lowest).tolist()}


def test_corners_are_told_and_what_is_answered_is_carried_out():
    model = Model({"pick": [-5, 3], "place": [9, 9]}, corner_to_corner)
    episode = folded("gpt-fabric-like", model, "square", "square-triangle-bottom_left")
    assert episode.error is None, episode.error
    before, again = model.asked
    assert "fold" in before[-1]["content"]
    assert "outside" in again[-1]["content"]
    assert apart(episode, "bottom_left", "top_right") < 0.03


def apart(episode, one, other):
    """How far two keypoints are at the end [m], seen from above."""
    after = episode.steps[-1].after
    first, second = (after.positions[after.keypoints[name]][:2] for name in (one, other))
    return float(np.hypot(*(first - second)))


def test_a_plan_over_keypoints_is_carried_out_where_they_are_seen():
    plan = {"plan": [{"pick": ["bottom_left", "bottom_right"], "place": ["top_left", "top_right"]}]}
    model = Model({"plan": [{"pick": ["elbow"], "place": ["top_left"]}]}, plan)
    episode = folded("clasp-like", model, "rectangle", "rectangle-half-bottom")
    assert episode.error is None, episode.error
    assert "no keypoints elbow" in model.asked[1][-1]["content"]
    assert apart(episode, "bottom_left", "top_left") < 0.03
    assert apart(episode, "bottom_right", "top_right") < 0.03
    assert episode.steps[0].subgoal.text == "carry bottom left to top left and bottom right to top right"


@pytest.mark.parametrize("agent", ["gpt-fabric-like", "clasp-like"])
def test_a_refusal_ends_the_episode_with_its_reason(agent):
    model = Model({"refused": "it has no collar"})
    episode = folded(agent, model, "square", "square-corner-bottom_left")
    assert "it has no collar" in str(episode.error)
    assert len(model.asked) == 1
    assert not episode.steps


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_the_corners_of_a_square_are_found_however_it_lies(angle):
    corners = cv2.boxPoints(((200.0, 190.0), (120.0, 120.0), angle))
    mask = cv2.fillPoly(np.zeros((400, 400), np.uint8), [corners.round().astype(np.int32)], 1) > 0
    told = seen(mask, np.where(mask, 0.0005, 0.0))
    found = np.array(told["corners"])
    assert len(found) == 4
    assert np.abs(np.linalg.norm(found[:, None] - corners[None], axis=-1)).min(0).max() < 8
    assert np.hypot(*(np.array(told["middle"]) - [200, 190])) < 2


def test_the_edge_of_a_folded_flap_has_corners_too():
    mask = np.zeros((400, 400), bool)
    mask[100:300, 100:300] = True
    heights = np.where(mask, 0.0005, 0.0)
    heights[100:300, 100:170] = 0.0035
    found = np.array(seen(mask, heights)["corners"])
    assert np.linalg.norm(found - [170, 100], axis=-1).min() < 8
