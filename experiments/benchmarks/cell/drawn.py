"""Random folds of rectangular cloths as PolyFold makes them: random fold lines, picks by the default policy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from polyfold_fgpnp.policies.lines import random_line

from polyfold import plugins
from polyfold.errors import PlanError
from polyfold.geometry import Camera, contour_of
from polyfold.types import Scene

Floats = NDArray[np.float64]

CAMERA = Camera.framing(0.7)
"""It sees as much of the table as is deep."""


@dataclass(frozen=True, eq=False)
class DrawnFold:
    """One fold.

    Attributes:
        sides: of the cloth [m].
        picks, places: for the tools [m], shape (1 or 2, 3).
    """

    sides: tuple[float, float]
    picks: Floats
    places: Floats


def drawn_folds(
    seed: int, centre: tuple[float, float] = (0.0, 0.0), sides: tuple[float, float] = (0.3, 0.5), height: float = 0.004
) -> Iterator[DrawnFold]:
    """Folds without end, the same for the same seed.

    A rectangle lies at any angle, its middle within 3 cm of the middle of the workspace, so that all of it is seen.

    Args:
        seed: of everything random.
        centre: middle of the workspace [m].
        sides: shortest and longest side [m].
        height: of picks and places above the table [m].
    """
    rng = np.random.default_rng(seed)
    policy = plugins.create("policies", "affordance-pair")
    while True:
        size = rng.uniform(*sides, 2)
        scene = _scene(size, rng.uniform(0, 360), rng.uniform(-0.03, 0.03, 2))
        if scene is None:
            continue
        try:
            action = policy.act(random_line(scene, rng).line, scene, rng)
        except PlanError:
            continue
        middle = np.array([*centre, height])
        picks, places = (CAMERA.to_world(pixels) + middle for pixels in (action.picks, action.places))
        yield DrawnFold((float(size[0]), float(size[1])), picks, places)


def _scene(size: Floats, angle: float, middle: Floats) -> Scene | None:
    """What the camera sees of a rectangle; None if not all of it."""
    pixels = CAMERA.to_pixels(middle)
    corners = cv2.boxPoints((pixels.tolist(), (size * CAMERA.pixels_per_metre).tolist(), angle))
    if corners.min() < 2 or corners.max() > CAMERA.width - 3:
        return None
    mask = np.zeros((CAMERA.height, CAMERA.width), np.uint8)
    cv2.fillPoly(mask, [np.round(corners).astype(np.int32)], 1)
    seen = mask.astype(bool)
    return Scene("rectangle", (CAMERA.width, CAMERA.height), seen, contour_of(seen), None, "")
