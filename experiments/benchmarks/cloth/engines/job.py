"""A fold as every engine gets it, and what an engine gives back."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment
from polyfold.types import Action, SimState

Floats = NDArray[np.float64]

REACH, HEIGHT, CLEARANCE = 0.015, 0.45, 0.004
"""Radius of a grasp [m], height of the path as a share of its width, gap below the flap when it is let go [m]."""
SPEED, RAMP, SETTLING = 0.7, 0.15, 0.6
"""Speed of the gripper [m/s], time to reach it [s], time to come to rest [s]. Speed and ramp are our simulator's."""


class GaveUpError(Exception):
    """An engine used up its time."""


@dataclass(frozen=True, eq=False)
class Job:
    """A fold to do.

    Attributes:
        garment: what is folded.
        flat: particle positions at the start [m], shape (N, 3).
        held: indices of the held particles, shape (G,).
        arms: which arm holds each, shape (G,).
        starts, ends: pick and place points [m], shape (arms, 3).
        limit: processor time that an engine may use [s].
    """

    garment: Garment
    flat: Floats
    held: NDArray[np.int64]
    arms: NDArray[np.int64]
    starts: Floats
    ends: Floats
    limit: float

    @staticmethod
    def of(garment: Garment, flat: SimState, action: Action, limit: float) -> Job:
        """The fold that an action on a flat garment asks for; held is all cloth within ``REACH`` of the picks."""
        positions = flat.positions
        distances = np.array([np.hypot(*(positions - flat.camera.to_world(p))[:, :2].T) for p in action.picks])
        held = np.flatnonzero(distances.min(axis=0) <= REACH)
        arms = distances[:, held].argmin(axis=0)
        starts, ends = flat.camera.to_world(action.picks, 0.0), flat.camera.to_world(action.places, 0.0)
        return Job(garment, positions, held, arms, starts, ends, limit)

    def stacked(self, ground: float, gap: float) -> Job:
        """The same fold of plies as thick as an engine has them.

        Args:
            ground: height of the lowest ply above the table [m].
            gap: distance of one ply from the next [m].
        """
        layer = np.asarray(self.garment.mesh.layer, float)
        flat, starts, ends = self.flat.copy(), self.starts.copy(), self.ends.copy()
        flat[:, 2] = ground + gap * layer
        thickness = gap * layer.max()
        starts[:, 2] = ground + thickness / 2
        ends[:, 2] = ground + thickness + gap + thickness / 2 + CLEARANCE
        return replace(self, flat=flat, starts=starts, ends=ends)

    @property
    def duration(self) -> float:
        """Time of the motion [s]: along the longest path at ``SPEED`` with soft ends."""
        a, b = 0.5, HEIGHT
        length = np.pi / 2 * (3 * (a + b) - np.sqrt((3 * a + b) * (a + 3 * b)))  # half an ellipse (Ramanujan)
        return float(length * np.linalg.norm(self.ends - self.starts, axis=1).max() / SPEED + RAMP)

    def carried(self, progress: float) -> Floats:
        """Where the held particles belong [m], shape (G, 3), at ``progress`` from 0 to 1."""
        angle = np.pi * progress * progress * (3 - 2 * progress)
        c, s = np.cos(angle), np.sin(angle)
        span = self.ends - self.starts
        width = np.linalg.norm(span, axis=1, keepdims=True)
        forward = (span / width)[self.arms]
        centre = (self.starts + (1 - c) / 2 * span + np.array([0, 0, s * HEIGHT]) * width)[self.arms]
        offset = self.flat[self.held] - self.starts[self.arms]
        along, up = (offset * forward).sum(1), offset[:, 2]
        turned = offset + (c * along + s * up - along)[:, None] * forward
        turned[:, 2] = c * up - s * along
        return centre + turned

    def play(
        self,
        step: float,
        hold: Callable[[Floats], None],
        advance: Callable[[], None],
        release: Callable[[], None],
    ) -> float:
        """Fold in steps of this many seconds; the processor time that it took [s].

        Args:
            step: time step [s].
            hold: puts the held particles to positions [m], shape (G, 3).
            advance: does one step.
            release: opens the grippers.

        Raises:
            GaveUpError: if ``limit`` is used up.
        """
        started, steps = time.process_time(), round(self.duration / step)
        for index in range(steps + round(SETTLING / step)):
            if index < steps:
                hold(self.carried((index + 1) / steps))
            elif index == steps:
                release()
            advance()
            if time.process_time() - started > self.limit:
                raise GaveUpError
        return time.process_time() - started


Engine = Callable[[Job], tuple[Floats, float]]
"""Folds; gives the particles' positions [m], shape (N, 3), and the processor time without building the scene [s]."""
