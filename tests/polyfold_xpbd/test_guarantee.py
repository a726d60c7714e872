"""With ``guaranteed``, no ply ever passes through another, whatever the grippers do."""

import numpy as np
import pytest

from experiments.benchmarks.cloth.folding import cloth_mask, random_action
from experiments.benchmarks.cloth.measures import crossing_edges
from polyfold import plugins
from polyfold.types import Action

SEED, FOLDS = 2000, 3


def worst_of_folds(**params):
    """The most edges that pierce a triangle at any frame of three random folds of a square, and where it ends."""
    simulator = plugins.create("simulators", "xpbd", params)
    garment = plugins.generate_garment("square", SEED, 0.0155)
    picture, rng = simulator.reset(garment, SEED), np.random.default_rng(SEED)
    pierced = []
    simulator.record(lambda _: pierced.append(crossing_edges(garment.mesh, simulator.state().positions)), 30.0)
    for _ in range(FOLDS):
        picture = simulator.execute(random_action(cloth_mask(picture), rng)[0])
    return max(pierced), simulator


@pytest.fixture(scope="module")
def guaranteed():
    return worst_of_folds(guaranteed=True)


def test_nothing_is_pierced_at_any_frame_of_random_folds(guaranteed):
    assert guaranteed[0] == 0.0


def test_the_same_folds_pierce_without_the_guarantee():
    assert worst_of_folds()[0] > 0.0


def test_a_restored_state_goes_on_the_same_way(guaranteed):
    _, simulator = guaranteed
    simulator.record(None)
    before, corners = simulator.state(), simulator.state().keypoint_pixels()
    action = Action([corners["bottom_left"]], [corners["top_right"]])
    simulator.execute(action)
    once = simulator.state().positions
    simulator.restore(before)
    simulator.execute(action)
    assert np.array_equal(simulator.state().positions, once)
    assert np.linalg.norm(once - before.positions, axis=1).max() > 0.05


def test_grippers_that_want_to_pass_through_each_other_do_not():
    pierced = {}
    for guaranteed in (True, False):
        simulator = plugins.create("simulators", "xpbd", {"guaranteed": guaranteed})
        garment = plugins.generate_garment("tshirt", SEED, 0.025)
        simulator.reset(garment, SEED)
        solver, positions = simulator._solver, simulator._solver.positions()
        middle = np.flatnonzero(np.hypot(*positions[:, :2].T) < 0.05)
        upper = positions[middle, 2] > positions[middle, 2].mean()
        assert upper.any()
        assert not upper.all()
        solver.pin(middle)
        way = np.linspace(0.0, 0.03, 200)[:, None, None] * np.array([0.0, 0.0, 1.0])
        solver.carry(middle, positions[middle] + np.where(upper, -1.0, 1.0)[:, None] * way)
        pierced[guaranteed] = crossing_edges(garment.mesh, simulator.state().positions)
        assert np.isfinite(solver.positions()).all()
    assert pierced[True] == 0.0
    assert pierced[False] > 0.0
