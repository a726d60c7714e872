"""Registers the ``xpbd`` simulator."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_simulators(register):
    """Register the simulator."""
    register("xpbd", "polyfold_xpbd.simulator:XpbdSimulator", "position-based cloth in numba, RGB-D camera above")
