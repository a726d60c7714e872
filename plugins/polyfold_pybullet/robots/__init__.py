"""Robot models as data: which arms there are, where they stand, and what their URDF says of joints and limits."""

from polyfold_pybullet.robots.bundled import panda, robot_model, yumi
from polyfold_pybullet.robots.hulls import with_lean_hulls
from polyfold_pybullet.robots.models import Arm, RobotModel, Table
from polyfold_pybullet.robots.urdf import Chain, read_chain, written_part

__all__ = [
    "Arm",
    "Chain",
    "RobotModel",
    "Table",
    "panda",
    "read_chain",
    "robot_model",
    "with_lean_hulls",
    "written_part",
    "yumi",
]
