"""Registers the robot cell ``pybullet``: its arms, and the simulator that folds with them."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_robots(register):
    """Register the arms, simulated and real."""
    simulated = "polyfold_pybullet.arms:PybulletArms"
    register("pybullet", simulated, "two Pandas, a YuMi or arms by URDF, in PyBullet", ("polyfold[robot]",))
    drivers = "polyfold_pybullet.drivers"
    register("abb", f"{drivers}.abb:AbbArms", "two ABB arms at one IRC5, such as a YuMi", ("polyfold[abb]",))
    register("ur", f"{drivers}.ur:UrArms", "two UR arms with Robotiq hands, a controller each", ("polyfold[ur]",))


@hookimpl
def register_cameras(register):
    """Register the cameras."""
    realsense = "polyfold_pybullet.drivers.realsense:RealSense"
    register("realsense", realsense, "an Intel RealSense, or a recording of one", ("polyfold[realsense]",))


@hookimpl
def register_simulators(register):
    """Register the cell, in simulation and for real."""
    cell = "polyfold_pybullet.simulator:CellSimulator"
    register("pybullet", cell, "a robot cell: two arms and a depth camera", ("polyfold[robot]",))
    register("real-cell", "polyfold_pybullet.real.table:RealCell", "real cloth: your camera, your arms, your consent")


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register(
        "calibrate", "polyfold_pybullet.calibrating:Calibrate", "find where a camera is that looks at a board in a hand"
    )
    register("cell", "polyfold_pybullet.real.command:CellCommand", "look through a real cell's camera, park its arms")
