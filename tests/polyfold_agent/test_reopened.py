"""A planner may say that an earlier flap has come open: it is folded again first, once."""

import pytest

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.geometry import FoldLine
from polyfold.types import Subgoal

FIRST, SECOND = Subgoal("fold the left edge to the middle line"), Subgoal("fold the right edge to the middle line")


class Doubting:
    """Says of its second subgoal, as often as a test wants, that the first has come open."""

    doubts = 0

    def __init__(self):
        self.left, self.folds = Doubting.doubts, 0

    def subgoals(self, instruction, template, conversation):
        return [FIRST, SECOND]

    def plan(self, subgoal, scene, conversation):
        if subgoal == SECOND and self.left:
            self.left -= 1
            return FIRST
        rest = dict(zip(scene.model.names, scene.model.rest, strict=True))
        side, other = ("left", "right") if subgoal == FIRST else ("right", "left")
        self.folds += 1
        share = (0.1, 0.25)[min(self.folds, 2) - 1] if subgoal == FIRST else 0.25  # no flap is open here: fold further
        line = FoldLine.between(
            *((1 - share) * rest[f"{end}_{side}"] + share * rest[f"{end}_{other}"] for end in ("bottom", "top"))
        )
        return line if line.lifts(rest[f"top_{side}"]) else line.reversed()


@pytest.fixture
def folded():
    polyfold.register("planners", "doubting", Doubting)

    def fold(doubts):
        Doubting.doubts = doubts
        cloth = polyfold.garment("rectangle", seed=2003, edge_length=0.03)
        return attempt(
            "a gate",
            cloth,
            2003,
            polyfold.Experiment.of(planner="doubting", agent={"name": "polyfold", "recover": False}),
        )

    yield fold
    plugins.unregister("planners", "doubting")


def test_what_came_open_is_folded_again_before_the_rest(folded):
    assert [step.subgoal for step in folded(0).final_attempts()] == [FIRST, SECOND]
    assert [step.subgoal for step in folded(1).final_attempts()] == [FIRST, FIRST, SECOND]


def test_what_comes_open_twice_ends_the_episode_with_what_to_do(folded):
    episode = folded(2)
    assert episode.failure.stage == "planning"
    assert "folded twice" in episode.failure.reason
    assert len(episode.final_attempts()) == 2
