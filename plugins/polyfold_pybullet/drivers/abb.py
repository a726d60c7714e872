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
ANSWERS, STOP_TRIES = 3.0, 3
"""How long the controller may take to answer [s], and how often it is told to stop."""
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
        hand_s: float = Field(default=0.5, ge=0, le=10, description="how long a hand takes to close or open [s]")
        width_signals: tuple[str, str] | None = Field(
            default=None, description="analog signals with how wide the hands are [mm], where there are any"
        )

        @field_validator("tasks")
        @classmethod
        def _are_numbered(cls, tasks: tuple[str, str]) -> tuple[str, str]:
            # abb_motion_program_exec 0.7.4 names a task's file by its number, and its RAPID modules read them so.
            if not all(task[-1:].isdigit() for task in tasks) or tasks[0][-1] == tasks[1][-1]:
                raise ValueError(
                    "names of tasks end in a number of their own; a YuMi's T_ROB_L and T_ROB_R are to be called T_ROB1 "
                    "and T_ROB2 in its configuration, for the modules of abb_motion_program_exec"
                )
            return tasks

        @field_validator("units", "close_signals", "width_signals")
        @classmethod
        def _are_two(cls, names: tuple[str, str] | None) -> tuple[str, str] | None:
            if names is not None and names[0] == names[1]:
                raise ValueError("both arms have one name; each has its own")
            return names

        @field_validator("url")
        @classmethod
        def _is_an_address(cls, url: str) -> str:
            if not url.startswith(("http://", "https://")):
                raise ValueError("an address begins with http://, for example http://192.168.125.1:80")
            return url

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
        self._stopper: Any = None
        self._begun = False
        self._each: Callable[[float], None] = lambda _: None

    def connect(self) -> None:
        """Reach the controller, whose motors must be on and whose program must rest; nothing if it is reached."""
        if self._client is not None:
            return
        import abb_motion_program_exec.abb_motion_program_exec_client as abb

        self._stopper = self._services()
        self._client = abb.MotionProgramExecClient(abb_client=self._services())
        self.recover()
        if self._runs():
            raise RobotError(f"a program runs at {self._config.url}; stop it first")

    def close(self) -> None:
        """Leave the controller."""
        leaving, self._client, self._stopper = (self._client, self._stopper), None, None
        for each in leaving:
            if each is not None:
                getattr(each, "abb_client", each).close()

    def recover(self) -> None:
        """Look whether the motors are on: after an emergency stop they are not."""
        with self._answering():
            motors = self._client.abb_client.get_controller_state()
        if motors != "motoron":
            raise RobotError(f"the motors at {self._config.url} are off ({motors}); switch them on, in automatic mode")

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
        programs, tasks, self._each = self.programs(motion), list(self._config.tasks), each
        with self._answering():
            began = self._client.execute_multimove_motion_program(programs, tasks, wait=False)
        start = time.monotonic()
        while self._runs():
            spent = time.monotonic() - start
            each(min(spent, motion.duration))
            if spent > motion.duration + LATER:
                raise RobotError(
                    f"a motion of {motion.duration:.0f} s has not ended after {spent:.0f} s; look at the pendant"
                )
            time.sleep(LOOK)
        self._begun = False
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
            time.sleep(config.hand_s)
            if config.width_signals is None:
                return float("nan")
            return self._client.abb_client.get_analog_io(config.width_signals[arm], *config.signal_place) / 1000.0

    def stop(self) -> None:
        """Stop the program that was begun, and with it both arms: asked again and again until the controller hears."""
        if not self._begun or self._stopper is None:
            return
        said = ""
        for _ in range(STOP_TRIES):
            try:
                self._stopper.stop()
            except Exception as error:  # the library raises bare ones
                said = str(error)
            else:
                self._begun = False
                return
        raise RobotError(
            f"the controller at {self._config.url} can't be told to stop ({said}) and its arms may still move; "
            "press the emergency stop"
        )

    def _services(self) -> Any:
        """Robot Web Services that answer in time, and begin a program only if nobody has stopped meanwhile."""
        from abb_robot_client.rws import RWS
        from requests.adapters import HTTPAdapter

        link, config = self, self._config

        class Patient(HTTPAdapter):
            def send(self, request: Any, **settings: Any) -> Any:  # type: ignore[override]
                # abb_robot_client 0.4.0 waits for ever.
                return super().send(request, **{**settings, "timeout": settings.get("timeout") or ANSWERS})

        class Services(RWS):
            def start(self, cycle: str | None = "asis", tasks: list[str] | None = None) -> Any:
                link._each(0.0)
                link._begun = True
                try:
                    return super().start(cycle, tasks)
                finally:
                    # A stop that came before the controller had begun stopped nothing; what follows stops again.
                    link._begun = True

        found = Services(config.url, config.user, os.environ.get(config.password_env, "robotics"))
        for scheme in ("http://", "https://"):
            found._session.mount(scheme, Patient())
        return found

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
            raise RobotError(
                f"the controller at {self._config.url} said: {said}; check the address and the user, and look at the "
                "controller's event log"
            ) from error


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
