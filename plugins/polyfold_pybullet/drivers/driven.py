"""Arms that are planned for in the cell and driven by a link to their controllers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.errors import RobotError
from polyfold.plugins.hardware import RobotPlan
from polyfold_pybullet.arms import PybulletArms
from polyfold_pybullet.planning import Motion

Floats = NDArray[np.float64]

ARRIVED = 0.02
"""Joints that are farther from where a motion ends than this have not arrived [rad]."""


class Link(Protocol):
    """The way to the controllers of two arms. Methods raise RobotError where they fail."""

    def connect(self) -> None:
        """Open it without moving anything."""
        ...

    def close(self) -> None:
        """Release it."""
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
        """Stop both arms where they are, from any thread."""
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

    def __init__(self, config: Config, link: Link) -> None:
        super().__init__(config)
        self._link = link

    def connect(self) -> None:
        """Load the cell to plan in and open the link; moves nothing."""
        super().connect()
        try:
            self._link.connect()
            self._look()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop the arms and release them."""
        try:
            if self._cell is not None:
                self._link.stop()
                self._link.close()
        finally:
            super().close()

    def joint_state(self, arm: int) -> Floats:
        """An arm's joint angles, as measured now [rad], shape (N,)."""
        self._look()
        return super().joint_state(arm)

    def tcp_pose(self, arm: int) -> Floats:
        """Where an arm's tool is by the joints measured now, shape (4, 4)."""
        self._look()
        return super().tcp_pose(arm)

    def execute(self, plan: RobotPlan, watch: Callable[[float], None] | None = None) -> None:
        """Do what was planned, from parked to parked, if that is where the arms are."""
        self._look()
        super().execute(plan, watch)

    def park(self) -> None:
        """Open the hands and bring the arms to where they wait; allowed after a stop."""
        self._look()
        super().park()

    def gripper(self, arm: int, closed: bool) -> float:
        """Close or open a hand, and say how wide it is then, measured between the fingers [m]."""
        self._ready()
        self._refuse_after_a_stop()
        self._closed[arm] = closed
        width = self._link.grip(arm, closed)
        self._show()
        return width

    def stop(self) -> None:
        """Stop all arms where they are, from any thread; until parked they do nothing else."""
        super().stop()
        if self._cell is not None:
            self._link.stop()

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

        try:
            each(0.0)
            self._link.follow(motion, self.config.interval, each)
        except BaseException:
            self._stopped.set()
            self._link.stop()
            raise
        self._look()
        for name, now, joints in zip(self.arms, self._joints, motion.joints, strict=True):
            off = float(np.abs(now - joints[-1]).max())
            if off > ARRIVED:
                self.stop()
                raise RobotError(
                    f"{name} ended {off:.3f} rad from where its motion ends; look what is in its way, then call park"
                )
        return clock + motion.duration

    def _look(self) -> None:
        """Take over where the arms are."""
        self._ready()
        self._joints = [self._link.joints(arm) for arm in range(len(self.arms))]
        self._show()
