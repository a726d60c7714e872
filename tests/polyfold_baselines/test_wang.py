"""The search in a coarse copy: the copy lies as the garment does, and what is found there holds for the garment."""

import numpy as np
import pytest
from polyfold_baselines.agents.searching.planning import Copy
from polyfold_baselines.agents.searching.wang import Wang

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.config import ComponentSpec

COARSE = 0.022


@pytest.mark.parametrize("kind", ["square", "tshirt", "pants"])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_copy_lies_where_the_garment_lies_with_its_plies_and_openings(kind, seed):
    garment = plugins.generate_garment(kind, seed, COARSE)
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(garment, seed)
    flat = simulator.state()
    copy = Copy.of(garment.mesh, flat, kind, 300, ComponentSpec(name="xpbd"))
    lies = copy.simulator.state()
    assert 200 < len(lies.positions) < 450
    assert len(lies.positions) == len(copy.match)
    apart = np.linalg.norm(lies.positions[:, :2] - flat.positions[copy.match, :2], axis=1)
    assert apart.max() < 0.03, "no farther than the next particle"
    assert abs(lies.camera.pixels_per_metre / flat.camera.pixels_per_metre - 1) < 0.05
    assert 4 <= len(copy.corners) <= 24
    if kind != "square":
        assert lies.positions[:, 2].max() > 1.5 * lies.positions[:, 2].min(), "two plies"
    simulator.close()
    copy.simulator.close()


def folded(task, seed, **params):
    kind = task.split("-")[0]
    experiment = polyfold.Experiment.of(agent={"name": "wang", "params": params}, guidance="steps")
    garment = polyfold.garment(kind, seed, edge_length=COARSE)
    return attempt("", garment, seed, experiment, task=task)


def test_it_finds_the_corner_and_where_it_goes_and_is_marked_privileged():
    found = folded("square-corner-top_left", 3, samples=8, rounds=3, particles=200)
    again = folded("square-corner-top_left", 3, samples=8, rounds=3, particles=200)
    assert found.privileged
    assert found.fidelity.verdict != "bad"
    assert found.fidelity.moved_part_error_mm < 25
    assert (found.steps[0].action.picks == again.steps[0].action.picks).all()


def test_more_tries_come_nearer_in_the_copy():
    garment = plugins.generate_garment("square", 3, COARSE)
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(garment, 3)
    flat = simulator.state()
    costs = []
    for rounds in (1, 5):
        agent = Wang(Wang.Config(samples=6, rounds=rounds, particles=150, spread_m=0.2))
        agent._rng = np.random.default_rng(0)
        agent._copy = Copy.of(garment.mesh, flat, "square", 150, ComponentSpec(name="xpbd"))
        before = agent._copy.simulator.state()
        targets = before.positions.copy()
        moved = targets[:, 0] + targets[:, 1] > np.median(targets[:, 0] + targets[:, 1]) + 0.1
        targets[moved] = targets[moved] - 0.1
        costs.append(agent._searched(before, targets).cost)
    assert costs[1] < costs[0]


def test_a_task_of_two_folds_takes_two():
    assert len(folded("square-corners-top_left-top_right", 1, samples=4, rounds=1, particles=150).steps) == 2
