"""Registers the pick-and-place policies."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_policies(register):
    """Register the policies."""
    register("caso", "polyfold_fgpnp.policies.caso:Caso", "the best pair of picks by affordance, no learning")
    register(
        "vertex-random", "polyfold_fgpnp.policies.caso:VertexRandom", "a random polygon vertex, the second pick by caso"
    )
    register(
        "farthest", "polyfold_fgpnp.policies.caso:Farthest", "the point farthest from the line, the second pick by caso"
    )
    learned = "polyfold_fgpnp.policies.learned"
    register("csam+caso", f"{learned}:CoupledActionMap", "the best point of a learned map, the second pick by caso")
    register("vertex-learned", f"{learned}:VertexLearned", "the best polygon vertex by the learned map, then caso")
    register("1sam", f"{learned}:OneActionMap", "one arm at the best point of a learned map")
    register("2sam", f"{learned}:TwoActionMaps", "two arms at the best points of two learned maps")
    register("pair", f"{learned}:PairValue", "the two points with the best learned joint value")


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register(
        "collect", "polyfold_fgpnp.data.collect:Collect", "fold at random in simulation and record how it came out"
    )
    register("train", "polyfold_fgpnp.training.command:Train", "learn a value network from random folds")
    register("maps", "polyfold_fgpnp.studies.maps:Maps", "draw learned spatial action maps over garments")
