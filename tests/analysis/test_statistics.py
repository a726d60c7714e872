"""Intervals hold as often as they say, for other sentences and garments too; tests of differences agree with them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiments.benchmarks.coverage import DRAWS, Setting, coverage
from polyfold.analysis import mean, share
from polyfold.analysis._differences import difference, holm, share_difference
from polyfold.analysis._intervals import ratio, wilson

SETTINGS = [
    Setting(data, n, clustered)
    for data in ("normal", "skewed", "rate", "paired", "paired rate")
    for n, clustered in ((6, False), (20, False), (70, False), (70, True))
]


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
def test_intervals_hold_as_often_as_they_say(setting):
    found = coverage(setting, draws=DRAWS // 4, seed=3)
    error = 2.6 * math.sqrt(0.05 * 0.95 / (DRAWS // 4))
    assert found > (0.90 if setting.n < 20 else 0.93) - error


def test_the_order_in_which_episodes_ran_changes_no_interval():
    values = list(np.random.default_rng(3).exponential(size=70))
    assert mean(values) == mean(values[::-1]) == mean(sorted(values))
    garments = [k % 7 for k in range(70)]
    assert mean(values, garments) == mean(values[::-1], garments[::-1])


def test_episodes_of_few_garments_say_less_than_as_many_of_many():
    rng = np.random.default_rng(0)
    garments = np.repeat(np.arange(5), 20)
    values = (rng.normal(size=5)[garments] + 0.1 * rng.normal(size=100)).tolist()
    alone, together = mean(values), mean(values, garments.tolist())
    assert together.high - together.low > 4 * (alone.high - alone.low)


def test_all_of_a_few_is_no_proof_of_all():
    found = share([True] * 23)
    assert found.mean == 100.0
    assert found.low == pytest.approx(100 * wilson(1.0, 23)[0])
    assert found.low < 87


def test_what_is_unknown_is_left_out_and_nothing_is_not_a_number():
    assert mean([1.0, None, math.nan, 3.0]).mean == 2.0
    assert mean([1.0, None, math.nan, 3.0]).n == 2
    assert share([True, None, False]).n == 2
    assert ratio([3.0, 5.0], [2.0, 0.0]).mean == 1.5
    for nothing in (mean([None]), share([]), ratio([1.0], [0.0]), difference([1.0], [None])):
        assert nothing.n == 0
        assert math.isnan(nothing.mean)


def test_one_episode_says_nothing_of_others():
    assert (mean([2.0]).low, mean([2.0]).high) == (-math.inf, math.inf)


def test_a_difference_that_mcnemar_does_not_find_has_zero_in_its_interval():
    ours, theirs = [True] * 70, [False] * 4 + [True] * 66
    found = share_difference(ours, theirs)
    assert found.mean == pytest.approx(100 * 4 / 70)
    assert found.p == pytest.approx(0.125)
    assert found.low < 0 < found.high


def test_a_clear_difference_is_found():
    ours, theirs = [True] * 70, [False] * 12 + [True] * 58
    found = share_difference(ours, theirs)
    assert found.p < 0.001
    assert found.low > 0
    gaps = difference([1.0 + 0.01 * k for k in range(12)], [0.0] * 12)
    assert gaps.p == pytest.approx(2 / 2**12)


def test_differences_that_only_one_garment_shows_are_not_found():
    garments = [k // 10 for k in range(80)]
    ours = [5.0 if garment == 0 else 0.0 for garment in garments]
    assert difference(ours, [0.0] * 80, garments).p == 1.0
    assert difference(ours, [0.0] * 80).p < 0.01


@given(st.lists(st.one_of(st.none(), st.floats(0, 1)), max_size=12))
def test_holm_only_raises_and_keeps_the_order(values):
    adjusted = holm(values)
    known = [(p, q) for p, q in zip(values, adjusted, strict=True) if p is not None]
    assert [q is None for q in adjusted] == [p is None for p in values]
    assert all(p <= q <= 1.0 for p, q in known)
    assert [q for _, q in sorted(known)] == sorted(q for _, q in known)


def test_holm_of_a_known_example():
    assert holm([0.01, 0.04, None, 0.03]) == pytest.approx([0.03, 0.06, None, 0.06])


@given(st.integers(0, 30), st.integers(1, 30))
def test_shares_stay_within_their_limits(successes, n):
    found = share([k < successes for k in range(n)])
    assert 0.0 <= found.low <= found.mean + 1e-9
    assert found.mean <= found.high + 1e-9 <= 100.0 + 1e-6
