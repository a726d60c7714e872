"""Robots that need no configuration: two Franka Pandas, which come with PyBullet, and ABB's YuMi."""

from __future__ import annotations

import math
from importlib.util import find_spec
from pathlib import Path

from polyfold.errors import ConfigError, did_you_mean
from polyfold_pybullet.robots.models import Arm, RobotModel, Table

_QUARTER = math.pi / 4

_PANDA_ACCELERATION = (3.75, 1.875, 2.5, 3.125, 3.75, 5.0, 5.0)
"""[rad/s²]: a quarter of what Franka allows (15, 7.5, 10, 12.5, 15, 20, 20), as panda_moveit_config has it."""
_PANDA_HOME = (0.0, -_QUARTER, 0.0, -3 * _QUARTER, 0.0, 2 * _QUARTER, _QUARTER)
"""The ready posture of Franka's own examples: the hand points down before the base."""

_YUMI_ACCELERATION = (5.0,) * 7
"""[rad/s²]: ABB publishes none for its joints; as MoveIt's configurations of arms without a published limit choose."""


def panda(x: float = 0.3, y: float = -0.45) -> RobotModel:
    """Two Franka Pandas at the near side of the table, from the package ``pybullet_data``.

    Args:
        x, y: where their bases stand: at ``(-x, y)`` and ``(x, y)`` [m].
    """
    import pybullet_data

    urdf = str(Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf")

    def arm(name: str, side: float) -> Arm:
        return Arm(
            name=name,
            urdf=urdf,
            base_position=(side * x, y, 0.0),
            base_rpy=(0.0, 0.0, math.pi / 2),
            joints=tuple(f"panda_joint{number}" for number in range(1, 8)),
            tool_link="panda_hand",
            tool_position=(0.0, 0.0, 0.112),  # where the fingers of the collision mesh end
            home=_PANDA_HOME,
            # Turned outwards and drawn back, so that the camera sees the whole table.
            park=(-side * 1.2, -0.7, 0.0, -2.7, 0.0, 2.0, _QUARTER),
            acceleration=_PANDA_ACCELERATION,
            fingers=("panda_finger_joint1", "panda_finger_joint2"),
            open_width=0.02,
            tips=("panda_leftfinger", "panda_rightfinger"),
        )

    return RobotModel(name="panda", arms=(arm("left", -1.0), arm("right", 1.0)))


def yumi(y: float = -0.40) -> RobotModel:
    """ABB's YuMi (IRB 14000) at the near side of a table, from the package ``rtb-data`` (BSD licence).

    The table begins at y = -0.26 m, before the torso.

    Args:
        y: where it stands [m].

    Raises:
        ConfigError: the package is not installed, or is one that has no YuMi.
    """
    folder = _rtb_data() / "xacro"
    urdf = folder / "yumi_description" / "urdf" / "yumi.urdf"
    if not urdf.is_file():
        raise ConfigError("this version of rtb-data has no YuMi; pip install 'rtb-data==1.1.0'")

    def arm(name: str, side: str, home: tuple[float, ...], park: tuple[float, ...]) -> Arm:
        return Arm(
            name=name,
            urdf=str(urdf),
            package=str(folder),
            # The URDF puts its base 0.1 m above its root.
            base_position=(0.0, y, -0.1),
            base_rpy=(0.0, 0.0, math.pi / 2),
            joints=tuple(f"yumi_joint_{number}_{side}" for number in (1, 2, 7, 3, 4, 5, 6)),
            tool_link=f"gripper_{side}_base",
            tool_position=(0.0, 0.0, 0.136),
            tool_rpy=(0.0, 0.0, -math.pi / 2),  # its fingers open along x
            home=home,
            park=park,
            acceleration=_YUMI_ACCELERATION,
            has_torso=True,
            fingers=(f"gripper_{side}_joint", f"gripper_{side}_joint_m"),
            open_width=0.015,
            tips=(f"gripper_{side}_finger_r", f"gripper_{side}_finger_l"),
        )

    # Hands down over the table, elbows out, joints near the middle of their ranges; parked beside the table.
    home = (0.75, -0.97, -0.85, 0.60, -1.65, 1.17, -2.42)
    park = (0.05, -1.73, -1.13, 0.39, -1.29, 0.99, -2.23)
    mirror = (-1, 1, -1, 1, -1, 1, -1)
    return RobotModel(
        name="yumi",
        arms=(arm("left", "l", _product(home, mirror), _product(park, mirror)), arm("right", "r", home, park)),
        table=Table(y=(-0.26, 0.44)),
        stands=False,
    )


def robot_model(name: str) -> RobotModel:
    """A bundled robot by its name. Raises ConfigError for an unknown one."""
    known = {"panda": panda, "yumi": yumi}
    if name not in known:
        raise ConfigError(f"there is no robot {name!r}; {did_you_mean(name, known)}")
    return known[name]()


def _product(values: tuple[float, ...], factors: tuple[int, ...]) -> tuple[float, ...]:
    return tuple(value * factor for value, factor in zip(values, factors, strict=True))


def _rtb_data() -> Path:
    found = find_spec("rtbdata")
    if found is None or found.origin is None:
        raise ConfigError("the YuMi's model comes in the package rtb-data; pip install 'polyfold[yumi]'")
    return Path(found.origin).parent
