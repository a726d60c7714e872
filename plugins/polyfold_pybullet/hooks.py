"""Registers the robot ``pybullet``."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_robots(register):
    """Register the arms."""
    register("pybullet", "polyfold_pybullet.arms:PybulletArms", "two Pandas, a YuMi or arms by URDF, in PyBullet")
