"""Registers the baselines and the verbs that demonstrate folds to them and train them."""

from polyfold.plugins.hookspecs import hookimpl

TORCH = ("polyfold[torch]",)
BASELINES = ("polyfold[torch,baselines]",)


@hookimpl
def register_agents(register):
    """Register the agents."""
    agents = "polyfold_baselines.agents"
    imitating, searching = f"{agents}.imitating", f"{agents}.searching"
    register("nearest-demo", f"{imitating}.nearest:NearestDemo", "copies the closest demonstration")
    register("ppo", f"{agents}.ppo:Ppo", "depth and particles to folds, learned by trying", BASELINES)
    register(
        "ltf", f"{imitating}.ltf:LearningToFold", "goal pictures to values of drags, from folds nobody meant", TORCH
    )
    register("vcd", f"{searching}.vcd:Vcd", "tries drags in a learned model of what is seen of the cloth", TORCH)
    register("wang", f"{searching}.wang:Wang", "search in a simulator for a pick at a corner of a simplified mesh")
    register("foldsformer", f"{imitating}.foldsformer:Foldsformer", "goal pictures to heatmaps by attention", TORCH)
    register("foldsformer-2arm", f"{imitating}.foldsformer:Foldsformer2Arm", "the same with two arms", TORCH)
    register(
        "langdef", f"{imitating}.langdef:LangDef", "a sentence, depth and a graph to picks at its nodes", BASELINES
    )
    register("langdef-2arm", f"{imitating}.langdef:LangDef2Arm", "the same with two arms", BASELINES)
    register("bifold", f"{imitating}.bifold:BiFold", "a sentence and the cloth to heatmaps", BASELINES)
    register("metafold-like", f"{imitating}.metafold:MetaFoldLike", "a sentence to where points of cloth go", BASELINES)
    asking = f"{agents}.asking"
    register("gpt-fabric-like", f"{asking}.gpt_fabric:GptFabricLike", "corners told to a language model, one arm")
    register("clasp-like", f"{asking}.clasp:ClaspLike", "a language model's plan over named keypoints")


@hookimpl
def register_prompts(register):
    """Register the prompts of the agents that ask a language model."""
    register("baselines", "polyfold_baselines:prompts", "corner_moves, keypoint_skills")


@hookimpl
def register_commands(register):
    """Register the verbs."""
    register("demos", "polyfold_baselines.demos.command:Demos", "demonstrate folds for baselines to learn from")
    register("fit", "polyfold_baselines.learning.command:Fit", "train a baseline from demonstrations", TORCH)
