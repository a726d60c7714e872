"""Registers the robot cell ``pybullet``: its arms, and the simulator that folds with them."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_robots(register):
    """Register the arms."""
    register("pybullet", "polyfold_pybullet.arms:PybulletArms", "two Pandas, a YuMi or arms by URDF, in PyBullet")


@hookimpl
def register_simulators(register):
    """Register the cell, in simulation and for real."""
    register("pybullet", "polyfold_pybullet.simulator:CellSimulator", "a robot cell: two arms and a depth camera")
    register("real-cell", "polyfold_pybullet.real.table:RealCell", "real cloth: your camera, your arms, your consent")


@hookimpl
def register_commands(register):
    """Register the verb."""
    register(
        "calibrate", "polyfold_pybullet.calibrating:Calibrate", "find where a camera is that looks at a board in a hand"
    )
