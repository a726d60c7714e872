"""Which of the components that an experiment names an episode uses, and with which parameters."""

from __future__ import annotations

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.plugins import hookspecs
from polyfold.plugins._inspection import parameters
from polyfold.plugins._traits import UsesComponents


def components_in_use(experiment: Experiment) -> dict[str, ComponentSpec]:
    """By field of the experiment, the components in use, the defaults of their parameters included.

    These are the agent with what it is made of, its language model if it has one, and what shows and judges its
    episode.

    Raises:
        PluginError: if one is not installed.
        ConfigError: if one has an impossible parameter.
    """
    agent = plugins.component_class("agents", experiment.agent.name.partition(":")[0])
    asks = ("llm",) if "instruction" in agent.requires else ()
    uses = agent.uses if isinstance(agent, UsesComponents) else ()
    fields = dict.fromkeys(("agent", "simulator", "segmenter", *uses, *asks))
    return {field: _with_defaults(field, getattr(experiment, field)) for field in fields}


def _with_defaults(field: str, spec: ComponentSpec) -> ComponentSpec:
    # The name keeps its argument, ``litellm:openai/gpt-4o``, which is one of the parameters too.
    return ComponentSpec(name=spec.name, params=dict(parameters(hookspecs.plural(field), spec)))
