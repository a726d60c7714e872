"""Registers the planners."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_planners(register):
    """Register the planners."""
    register(
        "hierarchical",
        "polyfold_planning.hierarchical:HierarchicalPlanner",
        "instruction to subgoals, then a fold line for each",
    )
    register("direct-1arm", "polyfold_planning.direct:DirectOneArm", "subgoals, then one pick and place for each")
    register("direct-2arm", "polyfold_planning.direct:DirectTwoArms", "subgoals, then picks and places of two arms")
    register(
        "zero-shot-vlm",
        "polyfold_planning.zero_shot:ZeroShotVLM",
        "picture and instruction to picks and places, fold by fold; needs a vision model",
    )
