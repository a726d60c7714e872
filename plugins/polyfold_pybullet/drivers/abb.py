"""The robot ``abb``: two ABB arms at one IRC5 controller, such as the YuMi, as programs that both run in step.

Through ``abb_motion_program_exec``, whose RAPID program has to be installed on the controller. One motion is one
program of ``MoveAbsJ`` between ``SyncMoveOn`` and ``SyncMoveOff``.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from polyfold.errors import RobotError
from polyfold_pybullet.drivers.driven import DrivenArms
from polyfold_pybullet.planning import Motion

Floats = NDArray[np.float64]

AXES = 6
"""Axes of a jointtarget; a seventh is its first external one."""
SEVENTH = 2
"""Where a YuMi's seventh axis stands among its joints, counted from the base."""
POINTS = 0.15
"""Time between two points of a program [s]: the controller rounds the corners between them."""
LATER = 10.0
"""How much longer than planned a program may take [s]."""
LOOK = 0.05
"""Time between two looks whether it runs [s]."""
FASTEST = 7000.0
"""Speed for what does not limit a move [mm/s, deg/s]."""


class AbbArms(DrivenArms):
    """Two ABB arms that run programs in step. Implements :class:`polyfold.plugins.hardware.Robot`."""

    class Config(DrivenArms.Config):
        """Where the controller is, and what its arms and signals are called."""

        robot: str = Field(default="yumi", description="yumi, or panda to plan for something else in tests")
        url: str = Field(description="the controller's address, for example http://192.168.125.1:80")
        user: str = Field(default="Default User", description="user at the controller")
        password_env: str = Field(
            default="ABB_PASSWORD", description="environment variable with the password; ABB's own if it is not set"
        )
        tasks: tuple[str, str] = Field(
            default=("T_ROB1", "T_ROB2"), description="RAPID tasks of the arms, the left one first"
        )
        units: tuple[str, str] = Field(default=("ROB_1", "ROB_2"), description="their mechanical units")
        close_signals: tuple[str, str] = Field(
            default=("polyfold_close_1", "polyfold_close_2"), description="digital signals that close the hands"
        )
        signal_place: tuple[str, str] = Field(
            default=("Local", "DRV_1"), description="network and unit of these signals"
        )
        width_signals: tuple[str, str] | None = Field(
            default=None, description="analog signals with how wide the hands are [mm], where there are any"
        )

        @field_validator("tasks")
        @classmethod
        def _are_numbered(cls, tasks: tuple[str, str]) -> tuple[str, str]:
            # abb_motion_program_exec 0.7.4 names a task's file by its number.
            if not all(task[-1:].isdigit() for task in tasks) or tasks[0][-1] == tasks[1][-1]:
                raise ValueError("names of tasks end in a number of their own, such as T_ROB1 and T_ROB2")
            return tasks

    def __init__(self, config: Config) -> None:
        super().__init__(config, AbbLink(config, self._tools))

    def _tools(self, motion: Motion, times: Floats) -> list[Floats]:
        """Poses of each arm's tool during a motion, shapes (S, 4, 4)."""
        kinematics = self._ready()[1].kinematics
        return [
            np.stack([arm.forward(row) for row in joints])
            for arm, joints in zip(kinematics, motion.at(times), strict=True)
        ]


class AbbLink:
    """The way to an IRC5 controller. Implements :class:`polyfold_pybullet.drivers.driven.Link`."""

    def __init__(self, config: AbbArms.Config, tools: Callable[[Motion, Floats], list[Floats]]) -> None:
        self._config, self._tools = config, tools
        self._client: Any = None

    def connect(self) -> None:
        """Reach the controller, whose motors must be on and whose program must rest."""
        import abb_motion_program_exec.abb_motion_program_exec_client as abb

        config = self._config
        password = os.environ.get(config.password_env, "robotics")
        self._client = abb.MotionProgramExecClient(config.url, config.user, password)
        with self._answering():
            motors = self._client.abb_client.get_controller_state()
            running = self._client.is_motion_program_running()
        if motors != "motoron":
            raise RobotError(f"the motors at {config.url} are off ({motors}); switch them on, in automatic mode")
        if running:
            raise RobotError(f"a program runs at {config.url}; stop it first")

    def close(self) -> None:
        """Leave the controller."""
        client, self._client = self._client, None
        if client is not None:
            client.abb_client.close()

    def joints(self, arm: int) -> Floats:
        """Joint angles, as measured [rad], shape (N,), from the base on."""
        with self._answering():
            told = self._client.abb_client.get_jointtarget(self._config.units[arm])
        axes = np.radians(np.asarray(told.robax, float))
        outer = float(np.asarray(told.extax, float)[0])
        # 9E9 is what ABB writes for an axis that there is not.
        return axes if outer > 1e8 else np.insert(axes, SEVENTH, np.radians(outer))

    def follow(self, motion: Motion, interval: float, each: Callable[[float], None]) -> None:
        """Have both arms run it as one program, and look whether it runs until it has ended."""
        with self._answering():
            began = self._client.execute_multimove_motion_program(
                self.programs(motion), list(self._config.tasks), wait=False
            )
        start = time.monotonic()
        while self._runs():
            spent = time.monotonic() - start
            each(min(spent, motion.duration))
            if spent > motion.duration + LATER:
                raise RobotError(
                    f"a motion of {motion.duration:.0f} s has not ended after {spent:.0f} s; look at the pendant"
                )
            time.sleep(LOOK)
        each(motion.duration)
        with self._answering():
            self._client.read_motion_program_result_log(began)

    def programs(self, motion: Motion) -> list[Any]:
        """A motion as a program for each arm."""
        import abb_motion_program_exec.abb_motion_program_exec_client as abb

        times = np.linspace(0.0, motion.duration, max(2, int(np.ceil(motion.duration / POINTS)) + 1))
        found = []
        for joints, tools in zip(motion.at(times), self._tools(motion, times), strict=True):
            program = abb.MotionProgram()
            program.SyncMoveOn()
            for count in range(1, len(times)):
                last = count == len(times) - 1
                zone = abb.zonedata(last, 5.0, 8.0, 8.0, 0.8, 8.0, 0.8)
                speed = _speed(abb, tools[count - 1], tools[count], times[count] - times[count - 1])
                program.MoveAbsJ(_target(abb, joints[count]), speed, zone)
            program.SyncMoveOff()
            found.append(program)
        return found

    def grip(self, arm: int, closed: bool) -> float:
        """Close or open a hand; how wide it is then is known where a signal says so [m]."""
        config = self._config
        with self._answering():
            self._client.abb_client.set_digital_io(config.close_signals[arm], closed, *config.signal_place)
            time.sleep(0.3)
            if config.width_signals is None:
                return float("nan")
            return self._client.abb_client.get_analog_io(config.width_signals[arm], *config.signal_place) / 1000.0

    def stop(self) -> None:
        """Stop the program, and with it both arms."""
        if self._client is not None and self._runs():
            with self._answering():
                self._client.stop_motion_program()

    def _runs(self) -> bool:
        with self._answering():
            return bool(self._client.is_motion_program_running())

    @contextmanager
    def _answering(self) -> Iterator[None]:
        """What the client raises, and all that the controller refuses, as a RobotError."""
        try:
            yield
        except RobotError:
            raise
        except Exception as error:  # the client raises bare ones
            said = " ".join(str(error).split())[:300]
            raise RobotError(f"the controller at {self._config.url} said: {said}; look at its event log") from error


def _target(abb: Any, joints: Floats) -> Any:
    degrees = np.degrees(joints)
    outer = [9e9] * AXES
    if len(degrees) == AXES + 1:
        outer[0] = float(degrees[SEVENTH])
        degrees = np.delete(degrees, SEVENTH)
    return abb.jointtarget(degrees.tolist(), outer)


def _speed(abb: Any, before: Floats, after: Floats, seconds: float) -> Any:
    """Speed of the tool along and about, so that a move takes as long as planned [mm/s, deg/s]."""
    from scipy.spatial.transform import Rotation

    way = 1000.0 * float(np.linalg.norm(after[:3, 3] - before[:3, 3]))
    turn = np.degrees(Rotation.from_matrix(before[:3, :3].T @ after[:3, :3]).magnitude())
    return abb.speeddata(max(way / seconds, 1.0), max(float(turn) / seconds, 1.0), FASTEST, FASTEST)
