"""Registers the baselines and the verbs that demonstrate folds to them and train them."""

from polyfold.plugins.hookspecs import hookimpl

TORCH = ("polyfold[torch]",)
BASELINES = ("polyfold[torch,baselines]",)


@hookimpl
def register_agents(register):
    """Register the agents."""
    agents = "polyfold_baselines.agents"
    register("nearest-demo", f"{agents}.nearest:NearestDemo", "copies the closest demonstration")
    register("ppo", f"{agents}.ppo:Ppo", "depth and particles to folds, learned by trying", BASELINES)
    register("ltf", f"{agents}.ltf:LearningToFold", "goal pictures to values of drags, from folds nobody meant", TORCH)
    register("vcd", f"{agents}.vcd:Vcd", "tries drags in a learned model of what is seen of the cloth", TORCH)
    register("wang", f"{agents}.wang:Wang", "search in a simulator for a pick at a corner of a simplified mesh")
    register("foldsformer", f"{agents}.foldsformer:Foldsformer", "goal pictures to heatmaps by attention", TORCH)
    register("foldsformer-2arm", f"{agents}.foldsformer:Foldsformer2Arm", "the same with two arms", TORCH)
    register("langdef", f"{agents}.langdef:LangDef", "a sentence, depth and a graph to picks at its nodes", BASELINES)
    register("langdef-2arm", f"{agents}.langdef:LangDef2Arm", "the same with two arms", BASELINES)
    register("bifold", f"{agents}.bifold:BiFold", "a sentence and the cloth to heatmaps", BASELINES)


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register("demos", "polyfold_baselines.demos.command:Demos", "demonstrate folds for baselines to learn from")
    register("fit", "polyfold_baselines.learning.command:Fit", "train a baseline from demonstrations", TORCH)
