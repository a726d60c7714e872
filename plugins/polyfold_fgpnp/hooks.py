"""Registers the pick-and-place policies."""

from polyfold.plugins.hookspecs import hookimpl

TORCH = ("polyfold[torch]",)

LEARNED = (
    ("csam+caso", "coupled:CoupledActionMap", "the best point of a learned map, the second pick by caso"),
    ("vertex-learned", "coupled:VertexLearned", "the best polygon vertex by the learned map, then caso"),
    ("1sam", "learned:OneActionMap", "one arm at the best point of a learned map"),
    ("2sam", "learned:TwoActionMaps", "two arms at the best points of two learned maps"),
    ("pair+caso", "coupled:CoupledPairValue", "the best point with its partner by a learned joint value"),
    ("pair", "coupled:PairValue", "the two points with the best learned joint value"),
)


@hookimpl
def register_policies(register):
    """Register the policies."""
    plain = "polyfold_fgpnp.policies.geometric"
    register("affordance-pair", f"{plain}:AffordancePair", "the best pair of picks by affordance, no learning")
    register("caso", f"{plain}:Caso", "a random contour point, the second pick by conditional affordance optimisation")
    register("vertex-random", f"{plain}:VertexRandom", "a random polygon vertex, the second pick by caso")
    register("one-arm", f"{plain}:OneArm", "one arm between the best pair, no learning")
    register("farthest", f"{plain}:Farthest", "the point farthest from the line, the second pick by caso")
    for name, target, summary in LEARNED:
        register(name, f"polyfold_fgpnp.policies.{target}", summary, TORCH)


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register(
        "collect", "polyfold_fgpnp.data.collect:Collect", "fold at random in simulation and record how it came out"
    )
    register("train", "polyfold_fgpnp.training.command:Train", "learn a value network from random folds", TORCH)
    register("maps", "polyfold_fgpnp.studies.maps:Maps", "draw learned spatial action maps over garments", TORCH)
