"""Arms that are planned for in the cell and driven by a link to their controllers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.errors import RobotError
from polyfold.plugins.hardware import RobotPlan
from polyfold_pybullet.arms import PybulletArms
from polyfold_pybullet.planning import Motion

Floats = NDArray[np.float64]

ARRIVED = 0.02
"""Joints that are farther from where a motion begins or ends than this are not there [rad]."""


class Link(Protocol):
    """The way to the controllers of two arms. Methods raise RobotError where they fail."""

    def connect(self) -> None:
        """Open it without moving anything; nothing if it is open."""
        ...

    def close(self) -> None:
        """Release it, whatever state it is in."""
        ...

    def recover(self) -> None:
        """Make the controllers ready to move again after a stop, without moving anything."""
        ...

    def joints(self, arm: int) -> Floats:
        """An arm's joint angles now, in the order of its model [rad], shape (N,)."""
        ...

    def follow(self, motion: Motion, interval: float, each: Callable[[float], None]) -> None:
        """Run a motion of both arms to its end.

        Args:
            motion: what to do.
            interval: time between two set points [s].
            each: to be called again and again with the time since the start [s]; what it raises ends the motion.
        """
        ...

    def grip(self, arm: int, closed: bool) -> float:
        """Close or open a hand, wait until it has, and say how wide it is then [m]; NaN if it can't be measured."""
        ...

    def stop(self) -> None:
        """Stop what this link has begun, both arms, from any thread; tries all before it raises."""
        ...


class DrivenArms(PybulletArms):
    """Arms that really move. Plans are made, and shown, in the cell; where the arms are is what they measure."""

    class Config(PybulletArms.Config):
        """As of the simulated arms, but slow unless told otherwise."""

        speed: float = Field(default=0.2, ge=0.01, le=1, description="share of the joints' limits of velocity")
        carry_speed: float = Field(default=0.15, ge=0.01, le=1, description="fastest move of a tool that carries [m/s]")
        transit_speed: float = Field(
            default=0.25, ge=0.01, le=1, description="fastest move of a tool that does not [m/s]"
        )

    _there: ClassVar[float] = 0.005
    """Arms that rest are measured with an error."""

    def __init__(self, config: Config, link: Link) -> None:
        super().__init__(config)
        self._link = link
        self._hands_known = False

    def connect(self) -> None:
        """Load the cell to plan in and open the link; moves nothing. Nothing if it is open."""
        if self._cell is not None:
            return
        super().connect()
        # What the hands hold is not known before they were opened.
        self._hands_known = False
        try:
            self._link.connect()
            self._sync()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop what moves and release the arms."""
        try:
            if self._cell is not None:
                self._stopped.set()
                try:
                    self._link.stop()
                finally:
                    self._link.close()
        finally:
            super().close()

    def joint_state(self, arm: int) -> Floats:
        """An arm's joint angles, as measured now [rad], shape (N,)."""
        self._sync()
        return super().joint_state(arm)

    def tcp_pose(self, arm: int) -> Floats:
        """Where an arm's tool is by the joints measured now, shape (4, 4)."""
        self._sync()
        return super().tcp_pose(arm)

    def execute(self, plan: RobotPlan, watch: Callable[[float], None] | None = None) -> None:
        """Do what was planned, from parked to parked, if that is where the arms are and their hands are empty."""
        if not self._hands_known:
            raise RobotError("nobody knows what the hands hold; call park first, which opens them")
        super().execute(plan, watch)

    def gripper(self, arm: int, closed: bool) -> float:
        """Close or open a hand, and say how wide it is then, measured between the fingers [m]."""
        self._ready()
        self._refuse_after_a_stop()
        width = self._link.grip(arm, closed)
        self._closed[arm] = closed
        self._show()
        return width

    def stop(self) -> None:
        """Stop all arms where they are, from any thread; until parked they do nothing else."""
        super().stop()
        if self._cell is not None:
            self._link.stop()

    def _sync(self) -> None:
        """Take over where the arms are. Raises RobotError if a controller says nonsense."""
        _, planner = self._ready()
        joints = [self._link.joints(arm) for arm in range(len(self.arms))]
        for name, now, kinematics in zip(self.arms, joints, planner.kinematics, strict=True):
            wanted = len(kinematics.chain.lower)
            if now.shape != (wanted,) or not np.isfinite(now).all():
                raise RobotError(
                    f"the controller of {name} says that its joints are at {now.round(3).tolist()}, of which there are "
                    f"{wanted}; check which arm is connected, and its model"
                )
        self._joints = joints
        self._show()

    def _open_hands(self) -> None:
        self._link.recover()
        for arm in range(len(self.arms)):
            self.gripper(arm, False)
        self._hands_known = True

    def _set_hands(self, closed: Sequence[bool]) -> None:
        for arm, wanted in enumerate(closed):
            if wanted != self._closed[arm]:
                self.gripper(arm, wanted)

    def _run(self, motion: Motion, clock: float, watch: Callable[[float], None] | None) -> float:
        """Have the link follow a motion that begins at ``clock`` [s]; returns when it ends."""

        def each(time: float) -> None:
            self._refuse_after_a_stop()
            if watch is not None:
                watch(clock + time)
            self._refuse_after_a_stop()

        if motion.duration <= 0.0:
            return clock
        self._refuse_elsewhere(motion, 0, "begins")
        try:
            each(0.0)
            self._link.follow(motion, self.config.interval, each)
        except BaseException:
            self.stop()
            raise
        self._sync()
        self._refuse_elsewhere(motion, -1, "ends")
        return clock + motion.duration

    def _refuse_elsewhere(self, motion: Motion, row: int, does: str) -> None:
        """Raises RobotError, and stops, if an arm is not where a motion begins or ends."""
        for name, now, joints in zip(self.arms, self._joints, motion.joints, strict=True):
            off = float(np.abs(now - joints[row]).max())
            if not off <= ARRIVED:
                self.stop()
                raise RobotError(
                    f"{name} is {off:.3f} rad from where its motion {does}; look what is in its way, then call park"
                )
