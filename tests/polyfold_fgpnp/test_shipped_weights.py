"""The weights that ship pick better than chance and than the farthest point, on t-shirts that nothing was trained on.

``heldout.zip`` was collected with ``polyfold collect --seeds 1150-1159 --mix uniform=16 --folds 640``: from each state
sixteen first picks at random were folded. What a policy would pick is compared with what came of these, so that nothing
is simulated here.
"""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.policies.region import fold_region

from polyfold import plugins
from polyfold.errors import PlanError

DATA = Path(__file__).parents[1] / "data" / "heldout.zip"
MARGIN_MM = {"random": 8.0, "farthest": 1.0}
"""How much less the picks by the map are off than others, at least."""


@pytest.fixture(scope="module")
def states():
    """Line, scene, first picks tried, shape (K, 2), and how far each fold ended from the ideal [mm], shape (K,)."""
    data, found = load_dataset(DATA), []
    for state in range(data.states):
        trials = np.flatnonzero(data["trial_state"] == state)
        trials = trials[np.isfinite(data.error_mm[trials])]
        line, scene = data.line(state), data.scene(state)
        try:
            fold_region(line, scene)
        except PlanError:
            continue  # as stored, rounded, the line cuts off nothing worth grasping
        if len(trials) > 3:
            found.append((line, scene, data["first"][trials].astype(float), data.error_mm[trials]))
    assert len(found) >= 30
    return found


@pytest.fixture(scope="module")
def policy():
    return plugins.create("policies", "csam+caso")


def error_by(states, value):
    """Mean error of the tried pick that a value, of line, scene and picks, puts first."""
    return float(np.mean([errors[np.argmax(value(line, scene, picks))] for line, scene, picks, errors in states]))


def values_at(points, values, picks):
    return values[np.argmin(((points - picks[:, None]) ** 2).sum(-1), axis=1)]


def by_map(policy):
    return lambda line, scene, picks: values_at(*policy.action_map(line, scene), picks)


def at_random(states):
    return float(np.mean([errors.mean() for *_, errors in states]))


def at_farthest(states):
    return error_by(states, lambda line, scene, picks: line.distance(picks))


def test_the_map_picks_better_than_chance_and_than_the_farthest_point(states, policy):
    ours = error_by(states, by_map(policy))
    assert ours < at_random(states) - MARGIN_MM["random"]
    assert ours < at_farthest(states) - MARGIN_MM["farthest"]


def test_a_flipped_map_does_not(states, policy):
    def flipped(line, scene, picks):
        points, values = policy.action_map(line, scene)
        middle = (np.asarray(line.start) + line.end) / 2
        along = np.subtract(line.end, line.start) / line.length
        mirrored = picks - 2 * ((picks - middle) @ along)[:, None] * along  # end for end, on the same side of the line
        return values_at(points, values, mirrored)

    assert error_by(states, flipped) > at_random(states) - MARGIN_MM["random"]


def test_a_map_of_the_other_direction_does_not(states, policy):
    # The line's ends exchanged, as by channels in the wrong order: the map is then of what stays on the table.
    def exchanged(line, scene, picks):
        points, values = policy.action_map(line.reversed(), scene)
        return values_at(line.mirror(points), values, picks)

    assert error_by(states, exchanged) > error_by(states, by_map(policy))
