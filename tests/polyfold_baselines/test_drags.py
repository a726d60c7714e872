"""Folds that nobody meant, and values of drags that are learned from them."""

import json
import shutil

import cv2
import numpy as np
import pytest
import torch
from demo_plan import PLAN
from polyfold_baselines.agents.imitating.ltf import LearningToFold
from polyfold_baselines.demos.cloths import CLOTH
from polyfold_baselines.demos.command import collect
from polyfold_baselines.demos.demonstrating import unpacked
from polyfold_baselines.demos.drags import DIRECTIONS, EACH, LENGTHS, drags
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import SIDE, in_view
from polyfold_baselines.learning.examples import make_examples
from polyfold_baselines.learning.fitting import FitConfig, fit
from polyfold_baselines.learning.networks.drag_values import DragValues
from polyfold_baselines.learning.weights import load

import polyfold
from polyfold.api import attempt
from polyfold.errors import ConfigError

SMALL = {"width": 32, "depth": 2, "precision": "float32", "batch": 8}


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


def test_the_cloth_under_the_pictures_is_kept_with_them(dragged):
    demos = Demos.read(dragged)
    cloths = list(demos.cloths())
    assert [cloth.rows.stop for cloth in cloths] == sorted({int(end) + 1 for end in demos.columns["end"]})
    for cloth in cloths:
        masks = [*demos.masks[cloth.rows], unpacked(demos.columns["goal_mask"][cloth.rows])[-1]]
        assert len(cloth.particles) == len(masks)
        lies = np.linalg.norm(cloth.rest - cloth.rest.mean(0), axis=1)
        seen = np.linalg.norm(cloth.particles[0, :, :2] - cloth.particles[0, :, :2].mean(0), axis=1)
        assert np.abs(lies - seen).max() < 0.005, "flat at first"
        for particles, mask in zip(cloth.particles, masks, strict=True):
            at = in_view(particles[:, :2], cloth.extent).round().astype(int)
            column, row = at[((at >= 0) & (at < SIDE)).all(1)].T
            near = cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8))
            assert near[row, column].mean() > 0.97, "no particle where no cloth is seen"


def test_older_drags_are_read_but_not_gone_on_with(dragged, tmp_path):
    old = tmp_path / "old"
    shutil.copytree(dragged, old)
    told = json.loads((old / "dataset.json").read_text())
    (old / "dataset.json").write_text(json.dumps({**told, "schema_version": 1}))
    for file in (old / "shards").glob("*.npz"):
        with np.load(file) as stored:
            kept = {name: stored[name] for name in stored.files if name not in CLOTH}
        np.savez_compressed(file, **kept)
    demos = Demos.read(old)
    for name, values in Demos.read(dragged).columns.items():
        assert demos.columns[name].tobytes() == values.tobytes()
    with pytest.raises(ConfigError, match="holds no particles"):
        next(demos.cloths())
    with pytest.raises(ConfigError, match="kept less of random drags"):
        collect(PLAN.model_copy(update={"agent": "random-drags", "arms": 1}), old, progress=False)


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
