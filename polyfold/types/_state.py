"""The true state of the cloth: for metrics, oracle and rewards, never for agents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold._brief import brief
from polyfold.geometry._camera import Camera

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class SimState:
    """Privileged state of a simulated cloth: for metrics, oracle and training rewards, never for agents.

    Of real cloth nobody knows it: then it has no particles, and says ``known`` of itself no more.

    Attributes:
        positions: particle positions [m], shape (N, 3).
        velocities: particle velocities [m/s], shape (N, 3).
        keypoints: named ground-truth keypoint -> particle index.
        camera: the camera in use.
        extra: simulator-specific arrays that :meth:`Simulator.restore` needs.
        grasped: how many plies each arm held in the fold that led here, 0 for an empty grip; None before a fold, or if
            the simulator doesn't say.
        short: how far from its place each arm stopped because the cloth reached no farther [m]; None as of ``grasped``.
        slipped: what share of the cloth that each arm held slipped out of its grip, 0 to 1; None as of ``grasped``.
    """

    positions: Floats
    velocities: Floats
    keypoints: Mapping[str, int]
    camera: Camera
    extra: Mapping[str, Any] = field(default_factory=dict)
    grasped: tuple[int, ...] | None = None
    short: tuple[float, ...] | None = None
    slipped: tuple[float, ...] | None = None

    __repr__ = brief

    @classmethod
    def of_real_cloth(cls, camera: Camera, grasped: tuple[int, ...] | None = None) -> SimState:
        """The state that nobody knows, under a camera, with what the hands measured of their last grips."""
        nothing = np.zeros((0, 3))
        return cls(nothing, nothing, {}, camera, grasped=grasped)

    @property
    def known(self) -> bool:
        """Whether it is known where the cloth is; else only pictures tell how a fold came out."""
        return len(self.positions) > 0

    def keypoint_positions(self) -> dict[str, Floats]:
        """Named keypoint -> position [m], shape (3,)."""
        return {name: self.positions[index] for name, index in self.keypoints.items()}

    def keypoint_pixels(self) -> dict[str, Floats]:
        """Named keypoint -> projected pixel, shape (2,)."""
        return {name: self.camera.to_pixels(point) for name, point in self.keypoint_positions().items()}
