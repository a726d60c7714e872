"""What affordance is for: flat cloth is folded well with the best pair of picks, and better than elsewhere.

First folds of flat cloth come out alike on every processor; folds of folded cloth don't, since rounding decides there
which way a layer slips. So what is claimed here of a few folds is claimed of flat cloth.
"""

import numpy as np
import pytest
from polyfold_fgpnp.data.outcomes import contour_reward, expect, particle_reward
from polyfold_fgpnp.data.situations import Situation, execute, scene_of
from polyfold_fgpnp.data.trials import Flap, draw_trials
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.geometric import AffordancePair
from polyfold_fgpnp.policies.lines import RandomLine
from polyfold_fgpnp.policies.region import fold_region

from polyfold import plugins
from polyfold.evaluation import known_tasks
from polyfold.tasks import fold_lines

HALVES = ("square-triangle-bottom_left", "rectangle-half-left", "tshirt-half-left", "pants-half-left")
SEED, EDGE_LENGTH, PICKS = 2001, 0.025, 4


@pytest.fixture(scope="module")
def rewards():
    """Rewards by particles and by contour of folding every kind in half, (kinds, picks, 2) each, by how was picked."""
    found = [rewards_of(task) for task in HALVES]
    return {name: np.array([one[name] for one in found]) for name in found[0]}


def rewards_of(task_id):
    kind = task_id.partition("-")[0]
    task = next(task for task in known_tasks(kind) if task.id == task_id)
    simulator, segmenter = plugins.create("simulators", "xpbd"), plugins.create("segmenters", "colour")
    garment = plugins.create("garments", kind).generate(SEED, EDGE_LENGTH)
    scene = scene_of(simulator.reset(garment, SEED), segmenter, kind)
    state = simulator.state()
    line = fold_lines(task, state.keypoint_pixels())[0]
    region = fold_region(line, scene)
    expectation = expect(region, scene.mask, state)
    rng = np.random.default_rng(0)
    situation = Situation(SEED, 0, RandomLine("middle", line, region), scene, state, expectation, rng)

    def reward(action):
        outcome, _ = execute(simulator, segmenter, situation, action)
        particles = particle_reward(outcome.error_mm, expectation.travel_mm)
        return float(particles), float(contour_reward(outcome.chamfer_px, expectation.idle_chamfer_px))

    drawn = {name: draw_trials(Flap(region), {name: PICKS}, np.random.default_rng(1)) for name in ("single", "uniform")}
    config = PickConfig()
    return {
        "affordance-pair": [reward(AffordancePair().act(line, scene, rng))],
        **{
            name: [reward(to_action(region, trial.first, trial.second, config)) for trial in trials]
            for name, trials in drawn.items()
        },
    }


def test_the_best_pair_folds_every_kind_well(rewards):
    assert (rewards["affordance-pair"] > 0.7).all()


def test_the_best_pair_is_better_than_one_arm_at_a_random_point(rewards):
    less = rewards["affordance-pair"].mean(1) - rewards["single"].mean(1)
    assert (less > 0.1).all(), "for every kind, by both rewards"


def test_affordance_beats_chance(rewards):
    less = rewards["affordance-pair"].mean(1) - rewards["uniform"].mean(1)
    assert (less.mean(0) > 0).all(), "over all kinds, by both rewards"


def test_no_reward_is_above_that_of_the_ideal_fold(rewards):
    assert all((found <= 1).all() for found in rewards.values())
