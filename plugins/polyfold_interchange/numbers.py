"""Picks and places as the numbers that other tools learn and give, and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold import Action
from polyfold.geometry import Camera

ACTION_NAMES = tuple(
    f"{what}{arm}_{axis}" for arm in (1, 2) for what in ("pick", "place") for axis in ("x", "y")
)  # fmt: skip
"""What the numbers of an action are: pick and place of the first arm, then of the second, each from −1 (left, top) to
1 (right, bottom) of the picture."""

STATE_NAMES = tuple(f"arm{arm}_{axis}" for arm in (1, 2) for axis in ("x", "y"))
"""What the numbers of a state are: where each arm last let go; 0, the middle, before the first fold."""

TOGETHER = 20.0
"""Picks of two arms nearer than this [px of 400] are one arm's."""


def as_numbers(action: Action, camera: Camera) -> NDArray[np.float32]:
    """An action as numbers, float32, shape (8,); a single arm's picks and places stand there twice."""
    picks, places = (np.repeat(points, 2 // len(points), axis=0) for points in (action.picks, action.places))
    return _scaled(np.stack([picks, places], axis=1), camera).astype(np.float32).reshape(8)


def as_action(numbers: ArrayLike, camera: Camera) -> Action:
    """The action of numbers, shape (8,); what lies outside the picture is brought to its border."""
    side = np.array([camera.width, camera.height], float)
    scaled = np.clip(np.asarray(numbers, float).reshape(2, 2, 2), -1.0, 1.0)
    points = np.clip((scaled + 1) / 2 * side - 0.5, -0.5, side - 0.5)
    picks, places = points[:, 0], points[:, 1]
    if np.hypot(*(picks[0] - picks[1])) < TOGETHER * camera.width / 400:
        return Action(picks.mean(axis=0, keepdims=True), places.mean(axis=0, keepdims=True))
    return Action(picks, places)


def state_after(numbers: ArrayLike | None) -> NDArray[np.float32]:
    """Where the arms are after an action of these numbers, float32, shape (4,); None before the first."""
    if numbers is None:
        return np.zeros(4, np.float32)
    return np.asarray(numbers, np.float32).reshape(2, 2, 2)[:, 1].reshape(4)


def _scaled(points: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    return (points + 0.5) / np.array([camera.width, camera.height]) * 2 - 1
