"""Registers the planners."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_planners(register):
    """Register the planners."""
    register(
        "hierarchical",
        "polyfold_planning.planners.hierarchical:HierarchicalPlanner",
        "instruction to subgoals, then a fold line for each",
    )
    register(
        "plan",
        "polyfold_planning.planners.one_call:OneCallPlanner",
        "every fold line in one call, again only where the cloth lies otherwise than expected",
    )
    register(
        "direct-1arm", "polyfold_planning.planners.direct:DirectOneArm", "subgoals, then one pick and place for each"
    )
    register(
        "direct-2arm", "polyfold_planning.planners.direct:DirectTwoArms", "subgoals, then picks and places of two arms"
    )
    register(
        "zero-shot-vlm",
        "polyfold_planning.planners.zero_shot:ZeroShotVLM",
        "picture and instruction to picks and places, fold by fold; needs a vision model",
    )
