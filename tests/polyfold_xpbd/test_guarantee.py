"""With ``guaranteed``, no ply ever passes through another, whatever the grippers do."""

import numpy as np
import pytest

from experiments.benchmarks.cloth.folding import cloth_mask, random_action
from experiments.benchmarks.cloth.measures import crossing_edges
from polyfold import plugins
from polyfold.errors import SimulationError
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


def test_a_state_made_without_the_guarantee_is_refused(guaranteed):
    _, simulator = guaranteed
    other = plugins.create("simulators", "xpbd")
    other.reset(plugins.generate_garment("square", SEED, 0.0155), SEED)
    with pytest.raises(SimulationError, match="without the guarantee"):
        simulator.restore(other.state())


def held_tshirt(guaranteed):
    """A simulator with a t-shirt held by its middle, the garment, what is held, and which of it is above."""
    simulator = plugins.create("simulators", "xpbd", {"guaranteed": guaranteed})
    garment = plugins.generate_garment("tshirt", SEED, 0.025)
    simulator.reset(garment, SEED)
    positions = simulator._solver.positions()
    middle = np.flatnonzero(np.hypot(*positions[:, :2].T) < 0.05)
    upper = positions[middle, 2] > positions[middle, 2].mean()
    assert upper.any()
    assert not upper.all()
    simulator._solver.pin(middle)
    return simulator, garment, middle, upper


def test_grippers_that_want_to_pass_through_each_other_do_not():
    pierced, lowest = {}, {}
    for guaranteed in (True, False):
        simulator, garment, middle, upper = held_tshirt(guaranteed)
        positions = simulator._solver.positions()[middle]
        way = np.linspace(0.0, 0.03, 200)[:, None, None] * np.array([0.0, 0.0, 1.0])
        simulator._solver.carry(middle, positions + np.where(upper, -1.0, 1.0)[:, None] * way)
        after = simulator.state().positions
        pierced[guaranteed], lowest[guaranteed] = crossing_edges(garment.mesh, after), after[:, 2].min()
        assert np.isfinite(after).all()
    assert pierced[True] == 0.0
    assert pierced[False] > 0.0
    assert lowest[True] > 0.0, "nothing is pushed into the table"


@pytest.mark.parametrize("step", [5e-8, 9e-8, 3e-7])
def test_however_slowly_a_gripper_pushes_it_does_not_get_through(step):
    simulator, garment, middle, upper = held_tshirt(True)
    positions, solver = simulator._solver.positions()[middle], simulator._solver
    down = np.where(upper, -1.0, 0.0)[:, None] * np.array([0.0, 0.0, 1.0])
    near = np.ptp(positions[:, 2]) - 8e-5
    solver.carry(middle, positions + down * np.linspace(0.0, near, 300)[:, None, None])
    for part in range(3):
        slow = near + step * np.arange(part * 800, (part + 1) * 800)[:, None, None]
        solver.carry(middle, positions + down * slow)
        assert crossing_edges(garment.mesh, simulator.state().positions) == 0.0
    now = solver.positions()[middle, 2]
    assert now[upper].min() > now[~upper].max()
