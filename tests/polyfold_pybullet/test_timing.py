"""Paths and their timing: smooth, within all limits, and no slower than a limit demands."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_pybullet.planning.timing import Path, Together, least_duration, run

VELOCITY, ACCELERATION = np.array([2.0, 1.5, 2.5]), np.array([3.0, 2.0, 5.0])
ROWS = st.lists(st.lists(st.floats(-2, 2, allow_subnormal=False), min_size=3, max_size=3), min_size=2, max_size=5).map(
    np.array
)


def moves(rows):
    return np.abs(np.diff(rows, axis=0)).max(axis=1).min() > 0.05


@given(ROWS.filter(moves))
@settings(max_examples=60, deadline=None)
def test_a_path_starts_rests_and_keeps_all_limits_of_which_it_meets_one(rows):
    path = Path(rows)
    duration = least_duration(path, VELOCITY, ACCELERATION)
    times, joints = run(path, duration, interval=duration / 2000)
    speed = np.gradient(joints, times, axis=0)
    # The ends of a numerical derivative are one-sided.
    change = np.gradient(speed, times, axis=0)[2:-2]
    np.testing.assert_allclose(joints[[0, -1]], rows[[0, -1]], atol=1e-9)
    np.testing.assert_allclose(speed[[0, -1]], 0, atol=1e-3)
    shares = np.abs(speed / VELOCITY).max(), np.abs(change / ACCELERATION).max()
    assert max(shares) <= 1.01
    assert max(shares) >= 0.9


@given(ROWS.filter(moves))
@settings(max_examples=30, deadline=None)
def test_a_path_passes_through_its_rows_in_small_steps(rows):
    sampled = Path(rows).sampled(0.01)
    assert max(np.abs(sampled - row).max(axis=1).min() for row in rows) < 0.02
    assert np.abs(np.diff(sampled, axis=0)).max() < 0.05


def test_a_tool_that_may_only_creep_takes_longer():
    path = Path(np.array([[0.0, 0, 0], [1.0, 0, 0]]))
    slow = least_duration(path, VELOCITY, ACCELERATION, lambda rows: rows[:, None], tool_speed=0.1)
    times, joints = run(path, slow)
    assert np.gradient(joints[:, 0], times).max() == pytest.approx(0.1, rel=0.02)


def test_paths_run_together_end_together_and_one_that_rests_stays():
    one, other = Path(np.array([[0.0, 0.0], [1.0, 2.0]])), Path(np.array([[0.5], [0.5]]))
    both = Together(one, other)
    assert not both.still
    assert other.still
    np.testing.assert_allclose(both(np.array([0.0, 0.5, 1.0])), [[0, 0, 0.5], [0.5, 1, 0.5], [1, 2, 0.5]])
