"""Success by pairs of keypoints: reachable by every ideal, and by no garment that lies as it lay."""

import math

import numpy as np
import pytest
from polyfold_wardrobe.keypoints import AsLeHome, KeypointPairs, conditions

from polyfold import plugins
from polyfold.evaluation import suite
from polyfold.tasks import Task, fold_lines
from polyfold.tasks._ideal import fold_step_by_step
from polyfold.types import Outcome

TASKS = [
    entry
    for name in ("polyfold70", "wardrobe")
    for entry in suite(name).entries
    if isinstance(entry, Task)
]  # fmt: skip


def ideal_of(task, seed):
    garment = plugins.generate_garment(task.garment, seed, 0.03)
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(garment, seed)
    flat = simulator.state()
    simulator.close()
    return fold_step_by_step(flat, garment, fold_lines(task, flat.keypoint_pixels()))[-1].outcome(flat, garment.mesh)


@pytest.mark.parametrize("task", TASKS[::3], ids=lambda task: task.id)
def test_the_ideal_meets_every_condition_and_doing_nothing_does_not(task):
    ideal = ideal_of(task, 5)
    untouched = Outcome(ideal.start, ideal.start, ideal.mask, ideal.mesh)
    met = KeypointPairs().score(ideal, [ideal])
    if math.isnan(met):
        pytest.skip("this fold moves no keypoint onto another, and leaves none where it was")
    assert met == 100.0
    assert AsLeHome.thresholds[0].holds(met)
    assert not AsLeHome.thresholds[0].holds(KeypointPairs().score(untouched, [ideal]))


def test_a_crumpled_garment_has_its_points_together_and_fails_all_the_same():
    task = suite("polyfold70").task("rectangle-half-left")
    ideal = ideal_of(task, 5)
    middle = ideal.end.positions.mean(axis=0)
    crumpled = np.broadcast_to(middle, ideal.end.positions.shape)
    from dataclasses import replace

    result = Outcome(ideal.start, replace(ideal.end, positions=crumpled), ideal.mask, ideal.mesh)
    failed = [words for words, holds in conditions(result, ideal) if not holds]
    assert failed
    assert all("away from" in words for words in failed)
    assert 0 < KeypointPairs().score(result, [ideal]) < 100
