"""Registers the pick-and-place policies."""

from polyfold.hookspecs import hookimpl


@hookimpl
def register_policies(register):
    """Register the policies."""
    register("caso", "polyfold_fgpnp.caso:Caso", "the best pair of picks by affordance, no learning")
    register("vertex-random", "polyfold_fgpnp.caso:VertexRandom", "a random polygon vertex, the second pick by caso")
    register("farthest", "polyfold_fgpnp.caso:Farthest", "the point farthest from the line, the second pick by caso")


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register("collect", "polyfold_fgpnp.collect:Collect", "fold at random in simulation and record how it came out")
