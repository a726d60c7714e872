"""Registers the planners."""

from polyfold.hookspecs import hookimpl


@hookimpl
def register_planners(register):
    """Register the planners."""
    register(
        "hierarchical",
        "polyfold_planning.hierarchical:HierarchicalPlanner",
        "instruction to subgoals, then a fold line for each",
    )
