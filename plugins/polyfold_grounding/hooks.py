"""Registers the groundings."""

from polyfold.hookspecs import hookimpl


@hookimpl
def register_groundings(register):
    """Register the groundings."""
    register("polygon", "polyfold_grounding.polygon:PolygonGrounding", "parameterized polygon fitted to the contour")
