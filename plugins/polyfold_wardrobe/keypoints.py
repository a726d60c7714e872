"""Success by distances between keypoints, as the LeHome Challenge judges folded garments (ICRA 2026).

There six points of a garment are watched: pairs that the fold brings together must end near each other (the hem's
corners at the shoulders, the cuffs at each other), pairs that it leaves apart must stay so, or the garment is crumpled.
Its thresholds are centimetres, written beside each of its meshes. Here the ideal fold says which pairs are which, and
the thresholds are shares of the garment's own span, so that they hold for every kind, size and task; the ideal meets
all of them by construction.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from polyfold.types import Outcome, Threshold

TOGETHER = 0.15
"""Pairs that the ideal brings together end at most this share of the span farther apart than there."""

APART = 0.7
"""Pairs that the ideal leaves apart keep at least this share of their distance there."""

NEARER = 0.85
"""A pair is brought together where an end at the limit is at most this share of its flat distance: else an untouched
garment would pass."""

LEFT = 0.9
"""A pair is left apart where it keeps at least this share of its flat distance."""

FAR = 0.25
"""Pairs that are nearer than this share of the span while flat say nothing."""


class KeypointPairs:
    """Share of the pairs of keypoints that are together, or apart, as the ideal has them."""

    unit: ClassVar[str] = "%"
    higher_is_better: ClassVar[bool] = True
    most: ClassVar[float] = 100.0

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The share [%] by the nearest reference; NaN where it moves no pair."""
        shares = [share for one in references if not math.isnan(share := _share(result, one))]
        return 100.0 * max(shares) if shares else math.nan


class AsLeHome:
    """Every pair is as the ideal has it."""

    thresholds: ClassVar[Sequence[Threshold]] = (Threshold("keypoint-pairs", 100.0, higher_is_better=True, best=100.0),)


def _share(result: Outcome, ideal: Outcome) -> float:
    found = list(conditions(result, ideal))
    if not any(" at " in words for words, _ in found):
        return math.nan  # doing nothing would meet all that is asked
    return sum(holds for _, holds in found) / len(found)


def conditions(result: Outcome, ideal: Outcome) -> Iterator[tuple[str, bool]]:
    """Each condition in words, and whether a result meets it."""
    flat, wanted, ended = (
        {name: np.asarray(point) for name, point in state.keypoint_positions().items()}
        for state in (ideal.start, ideal.end, result.end)
    )
    span = float(np.ptp(np.array(list(flat.values())), axis=0).max())
    for one, other in itertools.combinations(flat, 2):
        before, there, here = (math.dist(points[one], points[other]) for points in (flat, wanted, ended))
        if before < FAR * span:
            continue
        if there + TOGETHER * span <= NEARER * before:
            yield f"{one} at {other}", here <= there + TOGETHER * span
        elif there >= LEFT * before:
            yield f"{one} away from {other}", here >= APART * there
