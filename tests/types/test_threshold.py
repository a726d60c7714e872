"""Bounds of success criteria: what they allow is counted to the best value that there is."""

import math

import pytest

from polyfold.errors import ConfigError
from polyfold.types import Threshold


def test_a_share_in_percent_is_counted_to_one_hundred():
    percent, fraction = Threshold("covered", 90.0, True, best=100.0), Threshold("miou", 0.9, True)
    for value in (1.0, 0.95, 0.9, 0.5, 0.0):
        assert percent.share(100 * value) == pytest.approx(fraction.share(value))
        assert (percent.share(100 * value) <= 1.0 + 1e-9) == percent.holds(100 * value)


def test_a_bound_beyond_the_best_value_is_refused_with_what_to_do():
    with pytest.raises(ConfigError, match="best=100"):
        Threshold("covered", 90.0, higher_is_better=True)


@pytest.mark.parametrize("threshold", [Threshold("miou", 1.0, True), Threshold("mppe", 0.0)])
def test_a_bound_at_the_best_value_allows_nothing(threshold):
    assert threshold.share(threshold.bound) == 0.0
    assert threshold.share(0.5) == math.inf
