"""The oracle bounds what can be done, random bounds what must not count."""

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.types import Action


class OneCorner:
    """A policy that picks one point of the flap at random: the flap comes over askew."""

    def act(self, fold_line, scene, rng):
        flap = scene.contour[fold_line.lifts(scene.contour)]
        pick = flap[[0]] + 0.1 * (scene.contour.mean(axis=0) - flap[[0]])
        return Action(np.vstack([pick, pick + 30.0]), fold_line.mirror(np.vstack([pick, pick + 30.0])))


def folded(task, agent, kind="rectangle", seed=2003, **settings):
    cloth = polyfold.garment(kind, seed=seed, edge_length=0.0155)
    return attempt("", cloth, seed, polyfold.Experiment.of(agent=agent, **settings), task=task)


@pytest.mark.parametrize("task", ["rectangle-half-right-then-top", "rectangle-middle-left-right-half"])
def test_the_oracle_comes_nearer_to_the_ideal_than_its_first_picks(task):
    """Wide towels were dragged along, and narrow packets have no room for errors."""
    best, first = folded(task, "oracle", seed=2001), folded(task, "fold-lines", seed=2001)
    assert best.privileged
    assert best.fidelity.verdict == "good"
    assert best.fidelity.iou >= first.fidelity.iou
    assert len(best.final_attempts()) == len(first.steps)


def test_the_oracle_leaves_the_best_of_what_it_tried(monkeypatch):
    polyfold.register("policies", "one-corner", OneCorner)
    try:
        episode = folded("rectangle-half-left", "oracle", policy="one-corner")
    finally:
        plugins.unregister("policies", "one-corner")
    assert sum(step.retry for step in episode.steps) > 2, "nothing it tried was near enough"
    assert all(np.array_equal(step.observation.rgb, episode.start.rgb) for step in episode.steps), "put back each time"
    goal = episode.ideal_lines[0].mirror(episode.initial_state.keypoint_pixels()["top_left"])
    off = [np.hypot(*(step.after.keypoint_pixels()["top_left"] - goal)) for step in episode.steps]
    assert off[-1] < off[0]
    assert any(np.array_equal(step.action.places, episode.steps[-1].action.places) for step in episode.steps[:-1])


def test_no_task_has_so_many_tries_that_its_episode_is_stopped():
    from polyfold_standard.agents.oracle import BUDGET

    from polyfold.rollout._rollout import MAX_STEPS

    assert BUDGET <= MAX_STEPS


def test_a_try_that_a_fault_spoils_is_made_again():
    """The best try is repeated until it lies there: under faults no two tries of the same picks are alike."""
    from polyfold_standard.agents.oracle import _Trial

    good, bad = Action(np.zeros((1, 2)), np.ones((1, 2))), Action(np.zeros((1, 2)), np.full((1, 2), 9.0))
    trial = _Trial(line=None, scene=None, state=None, ideal=None, action=good, waiting=[bad], repeats=3)
    assert trial.next_action(2.0, enough=0.6) is bad
    assert trial.next_action(5.0, enough=0.6) is good
    assert trial.next_action(9.0, enough=0.6) is good, "a slip; once more"
    assert trial.next_action(2.0, enough=0.6) is None


@pytest.mark.parametrize(("task", "folds"), [("rectangle-half-left", 1), ("rectangle-middle-left-right-half", 3)])
def test_random_makes_as_many_folds_as_the_task_takes(task, folds):
    assert len(folded(task, "random").steps) == folds


def test_where_the_number_of_folds_is_open_random_makes_its_own():
    cloth = polyfold.garment("square", seed=2000, edge_length=0.03)
    assert len(polyfold.fold("", cloth, agent={"name": "random", "folds": 3}).steps) == 3
