"""What picks and places from a language model must keep."""

from __future__ import annotations

import numpy as np

from polyfold.errors import PlanError
from polyfold.types import Action, Scene

OFF_CLOTH = 4.0
"""A pick this far from the visible cloth [px] still grasps its edge."""

LEAST_WAY = 10.0
"""Shorter ways from pick to place [px] fold nothing."""

APART = 5.0
"""Two grippers nearer to each other than this [px] would collide."""


def check_action(action: Action, scene: Scene) -> None:
    """Inside the image, picks on the cloth, places somewhere else, grippers apart.

    Raises:
        PlanError: saying what is wrong, in words for the model that wrote it.
    """
    width, height = scene.image_size
    for what, points in (("pick", action.picks), ("place", action.places)):
        for number, (x, y) in enumerate(points, 1):
            if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
                raise PlanError(f"{what} {number} ({x:.0f}, {y:.0f}) lies outside the {width} x {height} image")
    ys, xs = np.nonzero(scene.mask)
    for number, (pick, place) in enumerate(zip(action.picks, action.places, strict=True), 1):
        nearest = int(np.argmin((xs - pick[0]) ** 2 + (ys - pick[1]) ** 2))
        distance = float(np.hypot(xs[nearest] - pick[0], ys[nearest] - pick[1]))
        if distance > OFF_CLOTH:
            raise PlanError(
                f"pick {number} ({pick[0]:.0f}, {pick[1]:.0f}) lies {distance:.0f} px off the cloth and would grasp "
                f"nothing; the nearest cloth is at ({xs[nearest]}, {ys[nearest]})"
            )
        if np.hypot(*(place - pick)) < LEAST_WAY:
            raise PlanError(f"pick {number} and its place are less than {LEAST_WAY:.0f} px apart; nothing would move")
    for what, points in (("picks", action.picks), ("places", action.places)):
        if action.arms == 2 and np.hypot(*(points[0] - points[1])) < APART:
            raise PlanError(f"the two {what} are less than {APART:.0f} px apart; move them apart, or use one arm")
