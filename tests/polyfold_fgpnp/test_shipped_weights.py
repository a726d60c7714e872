"""The weights that ship pick better than chance on t-shirts that nothing was trained on, and know where is where.

``heldout.zip`` was collected with ``polyfold collect --seeds 1150-1159 --mix uniform=16 --folds 384``: from each of
24 states sixteen first picks at random were folded. What a map says of these picks is compared with what came of
them, so that nothing is simulated here. The map of ``csam+caso`` does not order them better than their distance from
the line does (rank correlation 0.39 and 0.43, affordance 0.51), that of ``pair+caso`` does (0.55): see the recorded
results.
"""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.data.packing import read_packed
from polyfold_fgpnp.policies.weights import load_weights, weights_file
from polyfold_fgpnp.training.ranks import rank_correlation

from polyfold import plugins

DATA = Path(__file__).parents[1] / "data" / "heldout.zip"
PUBLISHED = Path(__file__).parents[2] / "experiments" / "data"

LESS_THAN_CHANCE = 4.0
"""How much less picks by the map are off than those at random, at least [mm]."""

LESS_THAN_FARTHEST = 2.0
"""How much less picks by the values of pairs are off than those farthest from the line, at least [mm]."""

IN_PLACE = 0.1
"""How much better a map orders picks than the same map in the wrong place, at least, as a rank correlation."""


@pytest.fixture(scope="module")
def states():
    """Line, scene, first picks tried, shape (K, 2), how far each fold ended from the ideal [mm], and its reward."""
    data, found = load_dataset(DATA), []
    for state in range(data.states):
        trials = np.flatnonzero(data["trial_state"] == state)
        picks = data["first"][trials].astype(float)
        found.append(
            (data.line(state), data.scene(state), picks, data.error_mm[trials], data.reward("contour")[trials])
        )
    assert len(found) == 24
    return found


@pytest.fixture(scope="module")
def policy():
    return plugins.create("policies", "csam+caso")


def at(points, values, picks):
    return values[np.argmin(((points - picks[:, None]) ** 2).sum(-1), axis=1)]


def order(states, value):
    """Mean rank correlation of a value, of line, scene and picks, with what came of the picks."""
    return float(np.mean([rank_correlation(value(line, scene, picks), got) for line, scene, picks, _, got in states]))


def test_the_map_picks_better_than_chance(states, policy):
    by_map = [errors[np.argmax(at(*policy.action_map(line, scene), picks))] for line, scene, picks, errors, _ in states]
    assert np.mean(by_map) < np.mean([errors.mean() for *_, errors, _ in states]) - LESS_THAN_CHANCE


def test_values_of_pairs_pick_better_than_chance_and_than_the_farthest_point(states):
    def picked(value):
        return np.mean([errors[np.argmax(value(line, scene, picks))] for line, scene, picks, errors, _ in states])

    pairs = plugins.create("policies", "pair+caso")
    by_pairs = picked(lambda line, scene, picks: at(*pairs.action_map(line, scene), picks))
    assert by_pairs < picked(lambda line, scene, picks: line.distance(picks)) - LESS_THAN_FARTHEST
    assert by_pairs < np.mean([errors.mean() for *_, errors, _ in states]) - 2 * LESS_THAN_CHANCE


def test_a_map_that_is_flipped_or_of_the_other_direction_is_worse(states, policy):
    def flipped(line, scene, picks):
        middle = (np.asarray(line.start) + line.end) / 2
        along = np.subtract(line.end, line.start) / line.length
        # End for end, on the same side of the line.
        return at(*policy.action_map(line, scene), picks - 2 * ((picks - middle) @ along)[:, None] * along)

    def exchanged(line, scene, picks):
        # The line's ends exchanged, as by channels in the wrong order: a map of what stays on the table.
        points, values = policy.action_map(line.reversed(), scene)
        return at(line.mirror(points), values, picks)

    found = order(states, lambda line, scene, picks: at(*policy.action_map(line, scene), picks))
    assert found > order(states, flipped) + IN_PLACE
    assert found > order(states, exchanged) + IN_PLACE


EQUAL = {"csam-2000": "csam", "1sam": "1sam", "2sam": "2sam", "vertex-learned": "vertex"}
"""Weights of the paper's ablations, and the published data set that each learned from."""


@pytest.mark.parametrize("name", EQUAL)
def test_ablations_differ_in_what_they_value_and_in_the_picks_of_their_data_alone(name):
    def told(of):
        config = dict(load_weights(weights_file(of))[1].config)
        return {**config, "data": None, "network": {**config["network"], "variant": None}}

    network, provenance = load_weights(weights_file(name))
    assert told(name) == told("csam-2000")
    assert network.config.variant == name.removesuffix("-2000")
    assert (provenance.config["reward"], provenance.config["network"]["frame"]) == ("contour", "camera")
    description, _ = read_packed(PUBLISHED / f"folds-{EQUAL[name]}-0.zip")
    assert provenance.data == (description["hash"],)
    assert 1700 < provenance.folds <= 2000


def test_policies_that_are_named_after_them_use_them():
    for name in ("1sam", "2sam", "vertex-learned"):
        assert plugins.create("policies", name).config.weights == name
    assert plugins.create("policies", "csam+caso").config.weights == "csam"
