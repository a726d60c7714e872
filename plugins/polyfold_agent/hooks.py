"""Registers the ``polyfold`` agent."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_agents(register):
    """Register the agent."""
    register(
        "polyfold", "polyfold_agent.agent:PolyFoldAgent", "segmenter, grounding, planner and policy, with recovery"
    )
