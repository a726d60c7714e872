"""Heatmaps, and the training that they are learned by."""

import json

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_baselines.agents.imitating.foldsformer import Foldsformer, Foldsformer2Arm
from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning import fitting, learner
from polyfold_baselines.learning.fitting import FitConfig, fit
from polyfold_baselines.learning.networks import heatmaps
from polyfold_baselines.learning.weights import load

from polyfold import plugins
from polyfold.errors import ConfigError

SMALL = {"width": 16, "depth": 1, "precision": "float32", "most_error_mm": 40.0, "batch": 8}
inside = st.floats(4, SIDE - 5)


def logits_of(points, side=SIDE // 2):
    return torch.log(heatmaps.targets(torch.tensor(points), side).clamp_min(1e-9)).flatten(1, 2)


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[inside] * 8))
def test_heatmaps_are_read_where_they_were_drawn_whatever_the_arms_are_called(values):
    points = np.array(values, np.float32).reshape(1, 2, 2, 2)
    logits = logits_of(points)
    everywhere = np.ones((1, SIDE, SIDE), bool)
    picks, places = heatmaps.read(logits, everywhere, 2)
    assert np.abs(picks[0] - points[0, :, 0]).max() < 2.0
    assert np.abs(places[0] - points[0, :, 1]).max() < 2.0
    swapped = torch.from_numpy(points[:, ::-1].copy())
    right, other = heatmaps.loss(logits, torch.from_numpy(points), 2), heatmaps.loss(logits, swapped, 2)
    assert right == pytest.approx(float(other), rel=1e-4)
    assert heatmaps.pick_error(picks, points[:, ::-1])[0] < 2.0


def test_picks_are_read_on_the_cloth_alone():
    points = np.array([[[[20, 20], [60, 60]], [[100, 100], [60, 60]]]], np.float32)
    cloth = np.zeros((1, SIDE, SIDE), bool)
    cloth[0, :, 40:] = True
    picks, _ = heatmaps.read(logits_of(points), cloth, 2)
    assert picks[0, 0, 0] >= 40
    assert np.abs(picks[0, 1] - 100).max() < 2


def test_one_arms_picks_stand_for_both_and_close_ones_are_one_arms():
    picks = np.array([[[10, 10], [np.nan, np.nan]]], np.float32)
    points = heatmaps.points_of(picks, picks + 20)
    assert (points[0, 0] == points[0, 1]).all()
    one, place = heatmaps.merged(np.array([[10.0, 10.0], [12.0, 10.0]]), np.array([[30.0, 30.0], [32.0, 30.0]]))
    assert one.tolist() == [[11.0, 10.0]]
    assert place.tolist() == [[31.0, 30.0]]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.floats(30, 98), st.floats(30, 98))
def test_what_is_turned_and_moved_takes_its_points_along(seed, x, y):
    points = torch.tensor([[[[x, y], [y, x]]] * 2])
    frames = heatmaps.targets(points[:, 0, :, :])[:, :, None].expand(1, 2, 2, SIDE, SIDE)
    moved, there = fitting._moved(frames, points, np.random.default_rng(seed))
    for frame, at in zip(moved[0, :, 0], there[0, 0], strict=True):
        rows, columns = torch.meshgrid(torch.arange(SIDE), torch.arange(SIDE), indexing="ij")
        whole = frame.sum()
        found = torch.stack([(columns * frame).sum() / whole, (rows * frame).sum() / whole])
        assert torch.allclose(found, at, atol=0.3)


@pytest.fixture(scope="module")
def overfitted(demonstrated, tmp_path_factory):
    out = tmp_path_factory.mktemp("fit")
    config = FitConfig(row="foldsformer-2arm", demos=str(demonstrated), passes=1200, learning_rate=2e-3, **SMALL)
    before = fit(config.model_copy(update={"passes": 8}), Foldsformer2Arm, tmp_path_factory.mktemp("b"), progress=False)
    return before, fit(config, Foldsformer2Arm, out, progress=False)


def test_it_learns_where_to_pick(overfitted):
    before, after = (load(path, "foldsformer-2arm", Foldsformer2Arm.network) for path in overfitted)
    assert after.measured["pick_error_px"] < 0.75 * before.measured["pick_error_px"]
    assert after.measured["held_out_loss"] < before.measured["held_out_loss"] - 1.0
    assert after.config["demos"] == before.config["demos"]
    assert len(after.config["demos"]) == 64


def test_it_folds_in_a_study_cell(overfitted):
    import polyfold
    from polyfold.api import attempt

    experiment = polyfold.Experiment.of(agent={"name": "foldsformer-2arm", "weights": str(overfitted[1])})
    cloth = polyfold.garment("square", seed=1001, edge_length=0.022)
    episode = attempt("", cloth, 1001, experiment, task="square-corner-bottom_left")
    assert len(episode.steps) == 1
    assert episode.error is None
    assert not episode.privileged


def test_a_killed_training_goes_on_to_the_same_weights(demonstrated, tmp_path, monkeypatch):
    monkeypatch.setattr(learner, "LOOK", 2)
    config = FitConfig(row="foldsformer-2arm", demos=str(demonstrated), passes=48, **SMALL)
    straight = fit(config, Foldsformer2Arm, tmp_path / "straight", progress=False)
    step = learner.Learner._step

    def interrupted(learning, number):
        if number == 3:
            raise KeyboardInterrupt
        return step(learning, number)

    with monkeypatch.context() as patch:
        patch.setattr(learner.Learner, "_step", interrupted)
        with pytest.raises(KeyboardInterrupt):
            fit(config, Foldsformer2Arm, tmp_path / "killed", progress=False)
    resumed = fit(config, Foldsformer2Arm, tmp_path / "killed", progress=False)
    one, other = (
        load(path, "foldsformer-2arm", Foldsformer2Arm.network).network.state_dict() for path in (straight, resumed)
    )
    assert all(torch.equal(one[name], other[name]) for name in one)
    with pytest.raises(ConfigError, match="another training"):
        fit(config.model_copy(update={"seed": 1}), Foldsformer2Arm, tmp_path / "killed", progress=False)
    lines = (tmp_path / "killed" / "metrics.jsonl").read_text().splitlines()
    assert [json.loads(line)["passes"] for line in lines] == [16, 32, 48]


def test_weights_that_were_changed_or_are_another_rows_are_refused(overfitted, tmp_path):
    content = bytearray(overfitted[1].read_bytes())
    content[-3] ^= 1
    (tmp_path / "changed.safetensors").write_bytes(content)
    with pytest.raises(ConfigError, match="was changed"):
        load(tmp_path / "changed.safetensors", "foldsformer-2arm", Foldsformer2Arm.network)
    with pytest.raises(ConfigError, match="not of langdef"):
        load(overfitted[1], "langdef", Foldsformer2Arm.network)
    segmenter = plugins.create("segmenters", "colour")
    with pytest.raises(ConfigError, match="polyfold fit foldsformer"):
        plugins.create("agents", "foldsformer", {"weights": tmp_path / "none"}, segmenter=segmenter)


def test_a_row_takes_its_own_weights_from_the_package_and_says_where_there_are_none(overfitted, tmp_path, monkeypatch):
    from polyfold_baselines.agents.imitating import imitation

    segmenter = plugins.create("segmenters", "colour")
    package = tmp_path / "package"
    monkeypatch.setattr(imitation, "__file__", str(package / "agents" / "imitating" / "imitation.py"))
    with pytest.raises(ConfigError, match="come with the package; make them with 'polyfold fit foldsformer-2arm'"):
        plugins.create("agents", "foldsformer-2arm", {}, segmenter=segmenter)
    (package / "weights").mkdir(parents=True)
    (package / "weights" / "foldsformer-2arm.safetensors").write_bytes(overfitted[1].read_bytes())
    assert plugins.create("agents", "foldsformer-2arm", {}, segmenter=segmenter)


def test_demonstrations_with_other_arms_than_a_row_has_are_refused(demonstrated, tmp_path):
    config = FitConfig(row="foldsformer", demos=str(demonstrated), passes=8, **SMALL)
    with pytest.raises(ConfigError, match=r"folds with 1 arm, and .* have 2; make some with 'polyfold demos --arms 1'"):
        fit(config, Foldsformer, tmp_path / "one", progress=False)
