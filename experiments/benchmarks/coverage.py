"""How often 95 % intervals hold: every kind of interval of our tables, on data whose truth is known.

For each setting many data sets are drawn; counted is how often the interval holds the true mean. Before stands what
tables had in 0.1: percentiles of a bootstrap that draws episodes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.analysis import Estimate, mean, share
from polyfold.analysis._differences import difference, share_difference

Floats = NDArray[np.float64]
Clusters = Sequence[Sequence[int]]

DRAWS, RESAMPLES = 2000, 500
DATA = ("normal", "skewed", "rate", "paired", "paired rate")
SIZES = {6: (3, 2), 10: (5, 2), 20: (5, 4), 70: (14, 5), 400: (100, 4)}
"""Sentences and garments of each size."""
ALIKE = (0.3, 0.05)
"""Share of the variance that episodes of a sentence, and of a garment, have in common where they are clustered."""
RATE, OTHER_RATE = 0.95, 0.90
"""Shares of success, the second of what the first is paired with."""


@dataclass(frozen=True)
class Setting:
    """Data to draw.

    Attributes:
        data: one of :data:`DATA`.
        n: episodes.
        clustered: whether episodes of a sentence or a garment are alike.
    """

    data: str
    n: int
    clustered: bool

    def __str__(self) -> str:
        return f"{self.data}, n = {self.n}{', clustered' if self.clustered else ''}"


def coverage(setting: Setting, draws: int = DRAWS, seed: int = 0, before: bool = False) -> float:
    """How often the interval holds the truth, 0 to 1.

    Args:
        setting: the data.
        draws: how many data sets.
        seed: of the draws.
        before: the former interval instead.
    """
    rng = np.random.default_rng(seed)
    clusters = _clusters(setting.n) if setting.clustered else ()
    held = 0
    for _ in range(draws):
        values, truth = _drawn(setting, clusters, rng)
        found = _percentiles(values, rng) if before else _estimated(setting.data, values, clusters)
        held += found.low <= truth <= found.high
    return held / draws


def _clusters(n: int) -> Clusters:
    sentences, garments = np.divmod(np.arange(n), SIZES[n][1])
    return sentences.tolist(), garments.tolist()


def _drawn(setting: Setting, clusters: Clusters, rng: np.random.Generator) -> tuple[list[NDArray[Any]], float]:
    """One data set, ours and, of pairs, theirs; and the true mean."""
    skewed = setting.data == "skewed"
    if setting.data in ("normal", "skewed"):
        return [_effects(setting.n, clusters, rng, skewed)], 0.0
    if setting.data == "paired":
        return [_effects(setting.n, clusters, rng) + 1.0, _effects(setting.n, clusters, rng)], 1.0
    success = [_standard(_effects(setting.n, clusters, rng)) < RATE]
    if setting.data == "rate":
        return success, 100 * RATE
    return [*success, _standard(_effects(setting.n, clusters, rng)) < OTHER_RATE], 100 * (RATE - OTHER_RATE)


def _effects(n: int, clusters: Clusters, rng: np.random.Generator, skewed: bool = False) -> Floats:
    """Values of mean 0 and variance 1, alike in clusters."""

    def drawn(count: int) -> Floats:
        return rng.exponential(size=count) - 1.0 if skewed else rng.normal(size=count)

    values = np.sqrt(1.0 - sum(ALIKE[: len(clusters)])) * drawn(n)
    for alike, codes in zip(ALIKE, clusters, strict=False):
        values += np.sqrt(alike) * drawn(max(codes) + 1)[codes]
    return values


def _standard(values: Floats) -> Floats:
    from scipy.special import ndtr

    return ndtr(values)


def _estimated(data: str, values: Sequence[NDArray[Any]], clusters: Clusters) -> Estimate:
    kinds = {"rate": share, "paired": difference, "paired rate": share_difference}
    return kinds.get(data, mean)(*(one.tolist() for one in values), *clusters)


def _percentiles(values: Sequence[NDArray[Any]], rng: np.random.Generator) -> Estimate:
    """The former interval."""
    one = np.asarray(values[0], float) - (np.asarray(values[1], float) if len(values) > 1 else 0.0)
    one = 100 * one if values[0].dtype == bool else one
    means = one[rng.integers(0, len(one), (RESAMPLES, len(one)))].mean(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return Estimate(float(one.mean()), float(low), float(high), len(one))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    from tqdm import tqdm

    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.coverage", description=__doc__)
    parser.add_argument("--draws", type=int, default=DRAWS, help=f"data sets per cell (default {DRAWS})")
    options = parser.parse_args(arguments)
    print("| data | clustered | interval | " + " | ".join(f"n = {n}" for n in SIZES) + " |")
    print("|---" * (3 + len(SIZES)) + "|")
    rows = [(data, clustered, before) for data in DATA for clustered in (False, True) for before in (True, False)]
    for data, clustered, before in tqdm(rows, file=sys.stderr):
        found = [coverage(Setting(data, n, clustered), options.draws, before=before) for n in SIZES]
        cells = [data, "yes" if clustered else "no", "before" if before else "now", *(f"{100 * c:.1f}" for c in found)]
        print("| " + " | ".join(cells) + " |")
    crossed = ", ".join(f"{sentences} × {garments}" for sentences, garments in SIZES.values())
    print(
        f"\nHow often a 95 % interval holds the truth [%], {options.draws} data sets a cell. Skewed: exponential. "
        f"Rates: {RATE:.0%}, paired with {OTHER_RATE:.0%}. Clustered: sentences × garments are {crossed}; "
        f"{ALIKE[0]:.0%} of the variance is common to a sentence, {ALIKE[1]:.0%} to a garment."
    )


if __name__ == "__main__":
    main()
