"""What went wrong with a fold, as the picture after it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from polyfold.types import Action, Observation
from polyfold_agent.recovery.attempt import Attempt, Motion
from polyfold_agent.recovery.bringing_over import bring_over
from polyfold_agent.recovery.cloth import Floats, Mask, heights, near, reach
from polyfold_agent.recovery.displacement import displacement
from polyfold_agent.recovery.expectation import Expectation

PICK_RADIUS = 8.0
"""Neighbourhood of a pick in which cloth is looked for [px]."""

COVERED = 0.4
"""Share of a pick's neighbourhood that is still cloth where the arm took nothing."""

UNEVEN = ((1.0, 0.2), (0.35, 0.7), (0.0, 1.0))
"""How much more of the flap came down at one place than at the other, and what share of the proof is enough then."""

LANDED = 0.5
"""Share of the flap's height at a place from which the flap did come down there."""

PULLED = 1.5
"""Cloth that was left behind is at most this much farther from its place than it was, for cloth does not stretch."""


@dataclass(frozen=True, eq=False)
class Finding:
    """What went wrong with a fold.

    Attributes:
        fault: ``missed`` when arms took nothing, ``astray`` when a part of the flap lies where it should not, ``left``
            when much of the flap is still on its side of the line.
        action: how to set it right; None where the whole fold should be chosen anew.
    """

    fault: Literal["missed", "astray", "left"]
    action: Action | None = None


def inspect(
    attempt: Attempt, observation: Observation, mask: Mask, remaining: float, astray: float
) -> tuple[Finding | None, Motion]:
    """Compare what a fold led to with what it should have.

    Args:
        attempt: the fold.
        observation: the picture after it.
        mask: the cloth in that picture, bool, shape (H, W).
        remaining: share of the flap's depth that, still left of the line, means a failed fold.
        astray: share of the flap's depth by which cloth beyond the expected outline means a failed fold.

    Returns:
        What went wrong, or None; and how the garment was displaced since the picture before.
    """
    motion = displacement(attempt, mask)
    moved = attempt.moved(motion)
    covered = [_covered(mask, moved.mask, pick) for pick in moved.action.picks]
    missed = np.array(covered) > COVERED
    if missed.all():
        return Finding("missed"), motion
    if missed.any():
        return Finding("missed", Action(moved.action.picks[missed], moved.action.places[missed])), motion
    return _misplaced(moved, observation, mask, remaining, astray), motion


def _misplaced(
    attempt: Attempt, observation: Observation, mask: Mask, remaining: float, astray: float
) -> Finding | None:
    """What is wrong though every arm took its cloth away, or None."""
    left = reach(mask, attempt.line) / attempt.depth
    if attempt.action.arms == 2:
        expected, seen = Expectation.of(attempt), heights(observation, mask)
        tip, beyond = expected.tip(mask)
        shares = np.array([expected.landed(seen, place) for place in attempt.action.places])
        enough = next(share for difference, share in UNEVEN if np.ptp(shares) >= difference)
        overhangs = left > enough * remaining and beyond > enough * astray * attempt.depth
        arm = int(np.argmin(shares))
        pick, place = attempt.action.picks[arm], attempt.action.places[arm]
        near_enough = np.hypot(*(place - tip)) <= PULLED * np.hypot(*(place - pick))
        if overhangs and shares[arm] < LANDED and near_enough:
            return Finding("astray", bring_over(attempt, mask, arm, tip))
    return Finding("left") if left > remaining else None


def _covered(mask: Mask, before: Mask, pick: Floats) -> float:
    """Share of the cloth around a pick that is still there."""
    around = near(pick, PICK_RADIUS, before)
    return float(mask[around].mean()) if around.any() else 0.0
