"""What cameras and robots must do, real or simulated: what moves things and sees them, apart from who decides.

Constructing a component moves and opens nothing; ``connect`` does, and ``close`` undoes it. Whoever has connected must
close, also after an error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["ArmLimits", "DepthCamera", "Infeasible", "RgbdFrame", "Robot", "RobotPlan"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RgbdFrame:
    """What a camera measured.

    Attributes:
        rgb: colours, uint8, shape (H, W, 3).
        depth: distance along the optical axis [m], NaN where none was measured, float32, shape (H, W).
        intrinsics: pinhole matrix [px], shape (3, 3).
        extrinsics: pose of the camera in the world, z along the optical axis, y down in the image, shape (4, 4).
        depth_noise: expected standard deviation of depth at the table [m]; NaN if nobody knows.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    intrinsics: Floats
    extrinsics: Floats
    depth_noise: float = float("nan")


@runtime_checkable
class DepthCamera(Protocol):
    """A camera that measures colour and depth."""

    def connect(self) -> None:
        """Open it; nothing if it is open. Raises RobotError if it can't be."""
        ...

    def close(self) -> None:
        """Release it; nothing if it is not open."""
        ...

    def get_rgbd(self, frames: int = 1) -> RgbdFrame:
        """A measurement, averaged over so many frames. Raises RobotError if there is none."""
        ...


@dataclass(frozen=True, eq=False)
class ArmLimits:
    """How an arm of N joints may move.

    Attributes:
        lower, upper: joint angles [rad, m if prismatic], shape (N,).
        velocity: [rad/s, m/s], shape (N,).
        acceleration: [rad/s², m/s²], shape (N,).
    """

    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats


@dataclass(frozen=True)
class Infeasible:
    """A fold that arms can't do as they stand.

    Attributes:
        reason: one line, of the attempt that came farthest.
        stage: how far that was: ``reach``, ``carry``, ``together`` or ``transit``.
    """

    reason: str
    stage: str


@runtime_checkable
class RobotPlan(Protocol):
    """A fold that a robot can do; what else it holds is the robot's own."""

    @property
    def mode(self) -> str:
        """``at once``, ``in sequence`` or ``one arm``."""
        ...

    @property
    def arms(self) -> tuple[int, ...]:
        """Which arm does each pick."""
        ...

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        ...


@runtime_checkable
class Robot(Protocol):
    """Arms that pick cloth up and lay it down. Arms are counted from 0; poses are of tools in the world, shape (4, 4).

    A tool's z axis points where the hand does, its y axis where the fingers open. Methods that move raise RobotError if
    the robot is not connected, if it was stopped, or if it can't move so; the arms then rest.
    """

    @property
    def arms(self) -> tuple[str, ...]:
        """What the arms are called."""
        ...

    def connect(self) -> None:
        """Open it without moving it; nothing if it is open. Raises RobotError if it can't be opened."""
        ...

    def close(self) -> None:
        """Release it; nothing if it is not open. Arms that move are stopped before."""
        ...

    def limits(self, arm: int) -> ArmLimits:
        """How an arm may move."""
        ...

    def tcp_pose(self, arm: int) -> Floats:
        """Where an arm's tool is now, shape (4, 4)."""
        ...

    def joint_state(self, arm: int) -> Floats:
        """An arm's joint angles now [rad, m], shape (N,)."""
        ...

    def plan(self, picks: ArrayLike, places: ArrayLike) -> RobotPlan | Infeasible:
        """How to take cloth at picks and lay it at places [m], shape (1 or 2, 3); moves nothing."""
        ...

    def execute(self, plan: RobotPlan, watch: Callable[[float], None] | None = None) -> None:
        """Do what was planned, from parked to parked.

        Args:
            plan: a plan of this robot.
            watch: called again and again with the time since the start [s]; it may call :meth:`stop`.
        """
        ...

    def move_linear(self, arm: int, pose: ArrayLike, speed: float = 0.1) -> None:
        """Move a tool on a straight line to a pose, at most at ``speed`` [m/s], while the other arm rests."""
        ...

    def gripper(self, arm: int, closed: bool) -> float:
        """Close or open a hand, and say how wide it is then, measured between the fingers [m]."""
        ...

    def park(self) -> None:
        """Bring the arms to where they wait, out of the camera's view. After a stop this is what may be asked next."""
        ...

    def stop(self) -> None:
        """Stop all arms where they are, from any thread."""
        ...
