import math

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.evaluation._criteria import criteria, needed_scale, succeeded
from polyfold.types import Outcome

TASKS = ("square-triangle-top_left", "square-corner-bottom_right")


def outcome(agent, task):
    cloth = polyfold.garment("square", seed=2003, edge_length=0.02)
    episode = attempt("", cloth, 0, polyfold.Experiment.of(agent=agent), task=task)
    mask = plugins.create("segmenters", "colour").segment(episode.final)
    return Outcome(episode.initial_state, episode.final_state, mask, cloth.mesh)


def scores(result, *references, **params):
    return {
        name: plugins.create("metrics", name, params.get(name)).score(result, references)
        for name in ("miou", "moved-part", "mppe")
    }


@pytest.mark.parametrize("task", TASKS)
def test_the_oracle_against_itself_is_perfect(task):
    values = scores(outcome("oracle", task), outcome("oracle", task))
    assert values == {"miou": 1.0, "moved-part": 0.0, "mppe": 0.0}
    assert succeeded(values, criteria(["strict"])["strict"])


@pytest.mark.parametrize("task", TASKS)
def test_doing_nothing_never_succeeds(task):
    values = scores(outcome("noop", task), outcome("oracle", task))
    assert not succeeded(values, criteria(["lenient"])["lenient"])


def test_the_nearest_reference_counts():
    result, other = outcome("oracle", TASKS[0]), outcome("oracle", TASKS[1])
    assert scores(result, other, result)["mppe"] == 0.0
    assert scores(result, other)["mppe"] > 20


def test_alignment_forgives_a_rigid_motion_only_when_asked():
    reference = outcome("oracle", TASKS[0])
    turned = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    moved = reference.end.positions @ turned + [0.1, 0.05, 0.0]
    end = polyfold.types.SimState(moved, reference.end.velocities, reference.end.keypoints, reference.end.camera)
    result = Outcome(reference.start, end, reference.mask, reference.mesh)
    assert scores(result, reference)["mppe"] > 50
    assert scores(result, reference, mppe={"align": True})["mppe"] == pytest.approx(0, abs=1e-6)


def test_aligned_overlap_and_moved_part_forgive_a_turn_too():
    reference = outcome("oracle", TASKS[0])
    quarter = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = reference.end.positions @ quarter
    end = polyfold.types.SimState(turned, reference.end.velocities, reference.end.keypoints, reference.end.camera)
    result = Outcome(reference.start, end, np.rot90(reference.mask), reference.mesh)
    plain = scores(result, reference)
    aligned = scores(result, reference, **{"miou": {"align": True}, "moved-part": {"align": True}})
    assert aligned["miou"] > 0.98 > plain["miou"]
    assert aligned["moved-part"] < 1e-6 < 50 < plain["moved-part"]


def test_where_nothing_was_measured_nothing_succeeded():
    bounds = criteria(["strict"])["strict"]
    nothing = {threshold.metric: math.nan for threshold in bounds}
    assert not succeeded(nothing, bounds)
    assert needed_scale(nothing, bounds) == math.inf
    still = {"mppe": 1.0, "miou": 0.99, "moved-part": math.nan}
    assert succeeded(still, bounds), "no part was to be moved, and none was"
