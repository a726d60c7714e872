"""The robot ``ur``: two arms of Universal Robots, each with a controller of its own, through ``ur_rtde``."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from polyfold.errors import RobotError
from polyfold_pybullet.drivers.driven import DrivenArms
from polyfold_pybullet.drivers.robotiq import PORT, RobotiqHand
from polyfold_pybullet.planning import Motion
from polyfold_pybullet.robots import RobotModel

Floats = NDArray[np.float64]

LOOKAHEAD, GAIN = 0.1, 300
"""How ``servoJ`` smooths what it is sent [s], and how stiffly it follows; the library's own examples use these."""
SLOWS = 2.0
"""Deceleration of the tool at the end and on a stop [m/s²]."""
LATE = 3
"""So many intervals late, and time is stretched: set points that are sent in a burst would be a jerk."""
LAGS = 0.25
"""An arm that is farther behind its set point than this does not follow [rad]."""
MAY_MOVE = (1, 2)
"""Safety modes in which it may: normal and reduced."""
STOPS = {3: "is stopped to protect itself", 4: "is in recovery mode", 5: "is stopped by a safeguard"} | dict.fromkeys(
    (6, 7), "has its emergency stop pressed"
)
"""What other modes mean; more are faults."""


class UrArms(DrivenArms):
    """Two UR arms at a table. Implements :class:`polyfold.plugins.hardware.Robot`.

    Set points go to both controllers in step; a controller that stops for its own reasons stops the other one.
    """

    class Config(DrivenArms.Config):
        """Where the controllers are, and what stands at the table."""

        hosts: tuple[str, str] = Field(description="addresses of the left and the right arm's controller")
        model: RobotModel | None = Field(description="both arms: their URDF, base, joints, tool, postures and limits")
        interval: float = Field(default=0.008, ge=0.002, le=0.1, description="time between two set points [s]")
        hand_port: int = Field(default=PORT, ge=1, le=65535, description="port of the Robotiq hands' URCap")

        @field_validator("hosts")
        @classmethod
        def _are_two(cls, hosts: tuple[str, str]) -> tuple[str, str]:
            if hosts[0] == hosts[1]:
                raise ValueError("both arms have one address; each controller has its own")
            return hosts

        @field_validator("model")
        @classmethod
        def _is_told(cls, model: RobotModel | None) -> RobotModel:
            if model is None:
                raise ValueError("nobody else knows your arms; describe them, as polyfold_pybullet.robots does a Panda")
            return model

    def __init__(self, config: Config) -> None:
        assert config.model is not None
        strokes = (2 * arm.open_width for arm in config.model.arms)
        hands = [
            RobotiqHand(host, stroke, config.hand_port) for host, stroke in zip(config.hosts, strokes, strict=True)
        ]
        super().__init__(config, UrLink(config.hosts, hands))


class UrLink:
    """The way to two controllers. Implements :class:`polyfold_pybullet.drivers.driven.Link`."""

    def __init__(self, hosts: tuple[str, str], hands: list[RobotiqHand]) -> None:
        self._hosts, self._hands = hosts, hands
        self._control: list[Any] = []
        self._receive: list[Any] = []

    def connect(self) -> None:
        """Open both controllers and hands; nothing if they are open."""
        if self._control:
            return
        import rtde_control  # pyright: ignore[reportMissingImports]
        import rtde_receive  # pyright: ignore[reportMissingImports]

        for host, hand in zip(self._hosts, self._hands, strict=True):
            try:
                self._receive.append(rtde_receive.RTDEReceiveInterface(host))
                self._control.append(rtde_control.RTDEControlInterface(host))
            except RuntimeError as error:
                raise RobotError(
                    f"the controller at {host} can't be reached ({error}); check its address, switch it on, and set it "
                    "to remote control"
                ) from error
            hand.connect()

    def close(self) -> None:
        """Release the controllers and hands, as far as they can be reached."""
        for hand in self._hands:
            hand.close()
        leaving = [control.stopScript for control in self._control]
        leaving += [interface.disconnect for interface in (*self._control, *self._receive)]
        self._control, self._receive = [], []
        for leave in leaving:
            with suppress(RuntimeError):  # a connection that is lost is left already
                leave()

    def recover(self) -> None:
        """Have both controllers listen again, as they don't after a stop of their own."""
        for host, control in zip(self._hosts, self._control, strict=True):
            with _reached(host):
                listens = control.isProgramRunning() or control.reuploadScript()
            if not listens:
                raise RobotError(f"the controller at {host} does not listen; unlock it at the pendant, then call park")

    def joints(self, arm: int) -> Floats:
        """Joint angles, as measured [rad], shape (6,)."""
        with _reached(self._hosts[arm]):
            return np.array(self._receive[arm].getActualQ(), float)

    def follow(self, motion: Motion, interval: float, each: Callable[[float], None]) -> None:
        """Send both arms their set points, one after the other in every interval."""
        due = time.monotonic()
        with self._serving():
            for count in range(int(np.ceil(motion.duration / interval)) + 1):
                at = min(count * interval, motion.duration)
                each(at)
                for arm, joints in enumerate(motion.at(np.array([at]))):
                    with _reached(self._hosts[arm]):
                        self._refuse_if_stopped(arm, joints[0])
                        taken = self._control[arm].servoJ(joints[0].tolist(), 0.0, 0.0, interval, LOOKAHEAD, GAIN)
                    if not taken:
                        raise RobotError(f"{self._hosts[arm]} takes no more set points; both arms were stopped")
                due = max(due + interval, time.monotonic() - LATE * interval)
                time.sleep(max(0.0, due - time.monotonic()))
            time.sleep(2 * LOOKAHEAD)  # what was sent last is reached so much later

    def grip(self, arm: int, closed: bool) -> float:
        """Close or open a hand, and say how wide it is then [m]."""
        return self._hands[arm].grip(closed)

    def stop(self) -> None:
        """Stop both arms where they are; the second one too if the first can't be told."""
        failed = []
        for host, control in zip(self._hosts, self._control, strict=False):
            try:
                control.servoStop(SLOWS)
            except RuntimeError as error:
                failed.append(f"{host} ({error})")
        if failed:
            raise RobotError(
                f"{' and '.join(failed)} can't be told to stop and may still move; press the emergency stop"
            )

    @contextmanager
    def _serving(self) -> Iterator[None]:
        try:
            yield
        finally:
            self.stop()

    def _refuse_if_stopped(self, arm: int, joints: Floats) -> None:
        """Raises RobotError if an arm may not move, or is far from where it was sent last."""
        receive, host = self._receive[arm], self._hosts[arm]
        if not receive.isConnected():
            raise RobotError(f"the connection to {host} is lost; both arms were stopped")
        mode = receive.getSafetyMode()
        if mode not in MAY_MOVE:
            raise RobotError(
                f"{host} {STOPS.get(mode, f'has a fault of its safety system ({mode})')}; look why, unlock it at the "
                "pendant, then call park"
            )
        behind = float(np.abs(self.joints(arm) - joints).max())
        if not behind <= LAGS:
            raise RobotError(
                f"{host} is {behind:.2f} rad behind its set points; look what is in its way and whether its speed is "
                "turned down at the pendant, then call park"
            )


@contextmanager
def _reached(host: str) -> Iterator[None]:
    """What the library raises where a controller does not answer, as a RobotError (which is no RuntimeError)."""
    try:
        yield
    except RuntimeError as error:
        raise RobotError(f"the connection to {host} is lost ({error}); look whether its arm rests") from error
