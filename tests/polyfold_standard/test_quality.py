"""Graded quality: 100 for the ideal, 0 for what was not done, and less for each thing that a judge would see."""

from dataclasses import replace

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.evaluation._references import ideal_reference
from polyfold.evaluation._suites import find_task
from polyfold.types import Outcome

TASK = "rectangle-half-left"


@pytest.fixture(scope="module")
def scene():
    """An episode of the oracle, and the ideal."""
    cloth = polyfold.garment("rectangle", seed=2002, edge_length=0.0155)
    episode = attempt("", cloth, 2002, polyfold.Experiment.of(agent="oracle"), task=TASK)
    return episode, ideal_reference(find_task(TASK, "rectangle"), cloth, episode.initial_state).outcome


def quality(result, reference, **params):
    return plugins.create("metrics", "quality", params).score(result, [reference])


def moved(ideal, positions):
    return replace(ideal, end=replace(ideal.end, positions=positions))


def test_the_ideal_is_perfect_and_nothing_is_nothing(scene):
    episode, ideal = scene
    assert quality(ideal, ideal) == pytest.approx(100.0)
    seen = plugins.create("segmenters", "colour").segment(episode.start)
    assert quality(Outcome(ideal.start, ideal.start, seen, ideal.mesh), ideal) == 0.0


def test_a_good_fold_has_a_good_grade(scene):
    episode, ideal = scene
    mask = plugins.create("segmenters", "colour").segment(episode.final)
    assert 85 < quality(Outcome(ideal.start, episode.final_state, mask, ideal.mesh), ideal) < 100


@pytest.mark.parametrize(("millimetres", "least", "most"), [(5.0, 90, 99), (20.0, 80, 92), (60.0, 0, 0)])
def test_edges_that_do_not_meet_cost(scene, millimetres, least, most):
    ideal = scene[1]
    lies = ideal.end.positions
    flap = np.linalg.norm(lies - ideal.start.positions, axis=1) > 0.02
    assert least <= quality(moved(ideal, lies + flap[:, None] * [0.0, millimetres / 1000, 0.0]), ideal) <= most


def test_loft_a_pleat_and_a_smaller_outline_cost(scene):
    ideal = scene[1]
    lofted = moved(ideal, ideal.end.positions + np.array([0.0, 0.0, 0.01]))
    pleated = ideal.end.positions.copy()
    middle = ideal.start.positions[:, 1].mean()
    across = np.abs(ideal.start.positions[:, 1] - middle) < 0.03
    pleated[across, 1] = middle + 0.2 * (pleated[across, 1] - middle)
    smaller = replace(ideal, mask=ideal.mask & (np.cumsum(ideal.mask, axis=0) % 5 > 0))
    for result in (lofted, moved(ideal, pleated), smaller):
        assert 50 < quality(result, ideal) < 97


def test_where_it_lies_costs_nothing_if_aligned(scene):
    ideal = scene[1]
    away = moved(ideal, ideal.end.positions + np.array([0.1, 0.0, 0.0]))
    assert quality(away, ideal) == 0.0
    assert quality(away, ideal, align=True) == pytest.approx(100.0)
