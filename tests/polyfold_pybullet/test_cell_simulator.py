"""Cloth in the robot cell, as an agent meets it."""

import logging

import numpy as np
import pytest
from polyfold_pybullet.robots import panda

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.plugins.interfaces import HasReferenceConfig, Simulator
from polyfold.types import Action

EDGE = 0.022
EXACT = {"views": 0, "noise": {"disparity_noise": 0, "quantum": 0, "bias": 0, "dropouts": 0, "edge_px": 0}}


@pytest.fixture(scope="module")
def towel():
    """About 0.3 by 0.4 m, well within both arms' reach."""
    return plugins.generate_garment("rectangle", 2002, EDGE)


def cell(**params):
    return plugins.create("simulators", "pybullet", params)


def half(state):
    """The bottom edge onto the top edge."""
    pixels = state.keypoint_pixels()
    return Action(
        np.array([pixels["bottom_left"], pixels["bottom_right"]]), np.array([pixels["top_left"], pixels["top_right"]])
    )


@pytest.fixture
def folded(towel):
    simulator = cell()
    simulator.reset(towel, 1)
    simulator.execute(half(simulator.state()))
    yield simulator
    simulator.close()


def test_it_is_a_simulator_whose_references_are_made_in_the_cloth_alone():
    simulator = cell()
    assert isinstance(simulator, Simulator)
    assert isinstance(simulator, HasReferenceConfig)
    assert simulator.reference_config(simulator.config) == ("xpbd", {"elevation": 0.9})


def test_a_fold_lands_within_the_errors_of_camera_and_calibration(folded, towel):
    (fold,) = folded.state().extra["cell"]
    assert fold["mode"] in ("at once", "in sequence")
    assert 2 < fold["seconds"] < 60
    assert all(grip["taken"] > 0 for grip in fold["grips"])
    assert all(0 < grip["off"] < 0.008 for grip in fold["grips"])
    assert min(folded.state().grasped) > 0
    places = folded.state().keypoint_positions()
    for bottom, top in (("bottom_left", "top_left"), ("bottom_right", "top_right")):
        assert np.linalg.norm((places[bottom] - places[top])[:2]) < 0.025


def test_depth_is_that_of_a_stereo_camera(folded):
    seen, again = folded.observe(), folded.observe()
    missing = np.isnan(seen.depth)
    assert 0.001 < missing.mean() < 0.05
    table = seen.depth[:60, :60][~missing[:60, :60]]
    assert 0.0005 < table.std() < 0.005
    assert not np.array_equal(seen.depth, again.depth, equal_nan=True)
    np.testing.assert_array_equal(seen.rgb, again.rgb)


def test_a_seed_gives_the_same_episode(towel):
    ends = []
    for _ in range(2):
        simulator = cell()
        simulator.reset(towel, 4)
        simulator.execute(half(simulator.state()))
        ends.append(simulator.state().positions.tobytes() + simulator.observe().depth.tobytes())
        simulator.close()
    assert ends[0] == ends[1]


def test_without_errors_the_tools_go_where_they_are_meant_to(towel):
    simulator = cell(**EXACT)
    simulator.reset(towel, 1)
    simulator.execute(half(simulator.state()))
    (fold,) = simulator.state().extra["cell"]
    assert all(grip["off"] < 0.0015 for grip in fold["grips"])


def test_a_bite_of_nothing_misses_what_is_measured_too_high(towel):
    taken = []
    for bite in (0.0, 0.01):
        held = []
        for seed in range(3):
            simulator = cell(bite=bite)
            simulator.reset(towel, seed)
            simulator.execute(half(simulator.state()))
            held += [grip["taken"] > 0 for fold in simulator.state().extra["cell"] for grip in fold["grips"]]
            simulator.close()
        taken.append(sum(held))
    assert taken[0] < taken[1] == 6


def test_what_arms_can_not_reach_is_left_with_its_reason(towel, caplog):
    simulator = cell(arms={"model": panda(y=-1.5).model_dump()})
    simulator.reset(towel, 1)
    before = simulator.state()
    with caplog.at_level(logging.WARNING):
        simulator.execute(half(before))
    after = simulator.state()
    (fold,) = after.extra["cell"]
    assert fold["mode"] == "infeasible"
    assert "can't reach" in fold["reason"]
    assert fold["reason"] in caplog.text
    assert after.grasped == (0, 0)
    np.testing.assert_array_equal(after.positions, before.positions)


def test_a_pick_without_depth_is_left_with_its_reason(towel, caplog):
    simulator = cell(frames=1, noise={"dropouts": 0.8})
    simulator.reset(towel, 1)
    with caplog.at_level(logging.WARNING):
        simulator.execute(half(simulator.state()))
    (fold,) = simulator.state().extra["cell"]
    assert fold["mode"] == "not seen"
    assert "no depth around the pixel" in caplog.text


def test_a_state_is_returned_to_with_what_became_of_its_folds(folded):
    state = folded.state()
    corner = state.keypoint_pixels()["top_left"]
    folded.execute(Action(corner[None], corner[None] + [20.0, 40.0]))
    assert len(folded.state().extra["cell"]) == 2
    folded.restore(state)
    np.testing.assert_array_equal(folded.state().positions, state.positions)
    assert folded.state().extra["cell"] == state.extra["cell"]
    assert folded.state().grasped == state.grasped


def test_a_state_is_returned_to_after_a_fold_that_was_broken_off(towel, monkeypatch):
    simulator = cell()
    simulator.reset(towel, 1)
    state = simulator.state()
    stepped = simulator._arms._show

    def interrupted():
        if np.abs(np.concatenate(simulator._arms._joints) - np.concatenate(parked)).max() > 0.1:
            raise KeyboardInterrupt
        stepped()

    parked = [joints.copy() for joints in simulator._arms._joints]
    monkeypatch.setattr(simulator._arms, "_show", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulator.execute(half(state))
    monkeypatch.undo()
    simulator.restore(state)
    simulator.execute(half(state))
    (fold,) = simulator.state().extra["cell"]
    assert fold["mode"] == "at once"


@pytest.mark.parametrize(
    ("params", "message"),
    [
        ({"cloth": "pybullet"}, "a cell holds no cell"),
        ({"views": 3}, "calibration needs 5 views and more; 0 takes the camera as exact"),
        ({"noise": {"correlation_px": 1e9}}, "less than or equal to 50"),
        ({"noise": {"bias": float("inf")}}, "0.1"),
    ],
)
def test_a_cell_that_can_not_be_is_refused(params, message):
    with pytest.raises(ConfigError, match=message):
        cell(**params)


def test_the_camera_hangs_where_it_does_whatever_else_is_said_of_the_cloth(towel):
    simulator = cell(cloth_params={"order": 2})
    assert simulator.reset(towel, 1).camera.elevation == 0.9
    assert cell(cloth="faulty", cloth_params={"miss": 0.5}).config.inner == {"miss": 0.5}
