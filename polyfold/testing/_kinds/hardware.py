"""What cameras and robots are held to, without connecting to any."""

from __future__ import annotations

from typing import Any

from polyfold.errors import RobotError
from polyfold.testing._checks import checks
from polyfold.testing._materials import without_network
from polyfold.testing._subjects import Subject


def _refused(subject: Subject, component: Any, method: str, *arguments: Any) -> None:
    try:
        getattr(component, method)(*arguments)
    except RobotError:
        return
    subject.require(
        False, method, f"{method} works before connect()", "raise RobotError('… is not connected; call connect()')"
    )


@checks("cameras", "made and closed it opens nothing, and unconnected it measures nothing")
def _camera(subject: Subject) -> None:
    with without_network() as asked:
        camera = subject.make()
        _refused(subject, camera, "get_rgbd", 1)
        camera.close()
        camera.close()
    subject.require(not asked, "__init__", "it is opened before connect()", "open it in connect()")


@checks("robots", "made and closed it moves nothing, and unconnected it refuses to")
def _robot(subject: Subject) -> None:
    with without_network() as asked:
        robot = subject.make()
        _refused(subject, robot, "park")
        robot.close()
        robot.close()
    subject.require(not asked, "__init__", "it is opened before connect()", "open it in connect()")
    subject.require(len(robot.arms) in (1, 2), "arms", f"it has {len(robot.arms)} arms", "name one or two")
