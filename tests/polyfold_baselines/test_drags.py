"""Folds that nobody meant, and values of drags that are learned from them."""

import numpy as np
import pytest
import torch
from demo_plan import PLAN
from polyfold_baselines.agents.ltf import LearningToFold
from polyfold_baselines.demos.command import collect
from polyfold_baselines.demos.drags import DIRECTIONS, EACH, LENGTHS, drags
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning.examples import make_examples
from polyfold_baselines.learning.fitting import FitConfig, fit
from polyfold_baselines.learning.networks.drag_values import DragValues
from polyfold_baselines.learning.weights import load

import polyfold
from polyfold.api import attempt
from polyfold.errors import ConfigError

SMALL = {"width": 32, "depth": 2, "precision": "float32", "batch": 8}


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    out = tmp_path_factory.mktemp("drags")
    collect(PLAN.model_copy(update={"agent": "random-drags", "arms": 1}), out, progress=False)
    return out


def test_drags_go_every_way_and_one_way_back():
    every = drags()
    assert every.shape == (DIRECTIONS * len(LENGTHS), 2)
    assert np.allclose(np.hypot(*every.T).reshape(DIRECTIONS, -1), np.array(LENGTHS) * SIDE)
    assert all(np.abs(every + one).sum(1).min() < 1e-9 for one in every)


def test_each_is_one_of_them_from_the_cloth_and_begins_where_the_last_one_ended(dragged):
    demos = Demos.read(dragged)
    assert len(demos) >= 0.7 * EACH * 9
    moved = demos.columns["places"][:, 0] - demos.columns["picks"][:, 0]
    assert np.abs(moved[:, None] - drags()).sum(2).min(1).max() < 0.01
    column, row = demos.columns["picks"][:, 0].round().astype(int).T
    assert demos.masks[np.arange(len(demos)), row, column].all()
    again = np.flatnonzero(demos.columns["step"] > 0)
    assert (demos.columns["goal_mask"][again - 1] == demos.columns["mask"][again]).all()
    with pytest.raises(ConfigError, match="--arms 1"):
        collect(PLAN.model_copy(update={"agent": "random-drags"}), dragged / "two", progress=False)


def test_values_are_read_where_they_are_highest_on_the_cloth():
    network = DragValues(16, 1)
    logits = torch.zeros(1, len(drags()), SIDE // 2, SIDE // 2)
    logits[0, 5, 10, 20], logits[0, 6, 40, 50] = 1.0, 2.0
    cloth = np.zeros((1, SIDE, SIDE), bool)
    cloth[0, :60, :60] = True
    picks, places = network.read(logits, cloth)
    assert picks[0, 0].tolist() == [40.5, 20.5]
    assert np.allclose(places[0, 0] - picks[0, 0], drags()[5])
    points = torch.tensor(np.stack([picks[0], places[0]], 1)[None].repeat(2, 1), dtype=torch.float32)
    drag, pixel = network._done(points)
    assert (int(drag), int(pixel)) == (5, 10 * (SIDE // 2) + 20)


def test_it_learns_which_drags_reached_which_goals_and_folds(dragged, tmp_path):
    """Of the few that it has seen: what it makes of others takes thousands."""
    config = FitConfig(row="ltf", demos=str(dragged), passes=720, learning_rate=3e-3, **SMALL)
    before = fit(config.model_copy(update={"passes": 8}), LearningToFold, tmp_path / "before", progress=False)
    after = fit(config, LearningToFold, tmp_path / "after", progress=False)
    learned, _ = make_examples(Demos.read(dragged), 1.0)
    points = torch.from_numpy(learned.points)
    with torch.inference_mode():
        losses = [
            float(load(path, "ltf", LearningToFold.network).network.loss(*learned.frames.unbind(1), points))
            for path in (before, after)
        ]
    assert losses[1] < losses[0] - 0.5
    experiment = polyfold.Experiment.of(agent={"name": "ltf", "weights": str(after)}, guidance="steps")
    cloth = polyfold.garment("square", seed=1001, edge_length=0.022)
    episode = attempt("", cloth, 1001, experiment, task="square-corner-bottom_left")
    assert len(episode.steps) == 1
    assert episode.error is None
    assert len(episode.steps[0].action.picks) == 1
