"""Registers the groundings."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_groundings(register):
    """Register the groundings."""
    register("polygon", "polyfold_grounding.polygon:PolygonGrounding", "parameterized polygon fitted to the contour")
    register(
        "keypoints",
        "polyfold_grounding.keypoints:KeypointsGrounding",
        "named keypoints while flat, nameless corners of the contour once folded",
    )
    register("misfit", "polyfold_grounding.misfit:Misfit", "another grounding with a polygon that fits badly")
    register("image", "polyfold_grounding.picture:ImageGrounding", "the picture alone; needs a vision model")
    register(
        "keypoints+image",
        "polyfold_grounding.picture:KeypointsImageGrounding",
        "keypoints and the picture; needs a vision model to gain from it",
    )
    register(
        "polygon+image",
        "polyfold_grounding.picture:PolygonImageGrounding",
        "polygon and the picture; needs a vision model to gain from it",
    )
