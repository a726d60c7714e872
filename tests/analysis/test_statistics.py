"""Means with intervals: they say the same of the same episodes."""

import numpy as np

from polyfold.analysis import estimate


def test_the_order_in_which_episodes_ran_changes_no_interval():
    values = list(np.random.default_rng(3).exponential(size=70))
    assert estimate(values) == estimate(values[::-1]) == estimate(sorted(values))
