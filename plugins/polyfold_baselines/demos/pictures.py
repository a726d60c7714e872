"""What demonstrations look like: the view before a fold with picks and places, and the goal beside it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold import viz
from polyfold.types import Action
from polyfold_baselines.demos.demonstrating import PER_METRE, unpacked
from polyfold_baselines.demos.store import Demos

MANY = 24
HIGHEST = 0.008
"""What is drawn lightest [m]."""


def sheet(demos: Demos, many: int = MANY) -> NDArray[np.uint8]:
    """Some folds spread over all, uint8, shape (H, W, 3)."""
    chosen = np.unique(np.linspace(0, len(demos) - 1, many).astype(int))
    cards = []
    for row in chosen:
        held = {name: values[row] for name, values in demos.columns.items()}
        arms = np.isfinite(held["picks"][:, 0])
        action = Action(held["picks"][arms], held["places"][arms])
        before = viz.overlay(_shaded(held["height"], held["mask"]), action=action, zoom=2.0)
        cards.append(
            viz.Card(
                (before, _shaded(held["goal_height"], held["goal_mask"])),
                f"{held['task']}, fold {held['step'] + 1} of {held['steps']}",
                f"{held['text']}; {held['error_mm']:.0f} mm from the ideal",
            )
        )
    return viz.score_sheet(cards, f"{len(demos)} folds; beside each what it should lead to")


def _shaded(heights: NDArray[np.uint16], mask: NDArray[np.uint8]) -> NDArray[np.uint8]:
    light = np.clip(heights / PER_METRE / HIGHEST, 0.0, 1.0)
    rgb = np.stack([90 + 150 * light, 110 + 120 * light, 160 + 60 * light], axis=-1)
    rgb[~unpacked(mask[None])[0]] = 240
    return rgb.astype(np.uint8)
