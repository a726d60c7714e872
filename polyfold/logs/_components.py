"""Which of the components that an experiment names an episode uses, and with which parameters."""

from __future__ import annotations

from collections.abc import Iterable

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.plugins import hookspecs
from polyfold.plugins._fabrics import chosen_fabric, is_usual
from polyfold.plugins._inspection import parameters
from polyfold.plugins._traits import UsesComponents


def components_in_use(experiment: Experiment, garment_kinds: Iterable[str] = ()) -> dict[str, ComponentSpec]:
    """By field of the experiment, the components in use, the defaults of their parameters included.

    These are the agent with what it is made of, its language model if it has one, what shows and judges its episode,
    and the fabric. One that follows from the kind of garment stands under ``fabric of tshirt`` and so on.

    Args:
        experiment: the experiment.
        garment_kinds: kinds that episodes are about.

    Raises:
        PluginError: if one is not installed.
        ConfigError: if one has an impossible parameter.
    """
    agent = plugins.component_class("agents", experiment.agent.name.partition(":")[0])
    asks = ("llm",) if "instruction" in agent.requires else ()
    uses = agent.uses if isinstance(agent, UsesComponents) else ()
    fields = dict.fromkeys(("agent", "simulator", "segmenter", *uses, *asks))
    used = {field: _with_defaults(hookspecs.plural(field), getattr(experiment, field)) for field in fields}
    return {**used, **_fabrics(experiment.fabric, garment_kinds)}


def _fabrics(choice: ComponentSpec, garment_kinds: Iterable[str]) -> dict[str, ComponentSpec]:
    if not is_usual("fabrics", choice):
        return {"fabric": _with_defaults("fabrics", choice)}
    return {f"fabric of {kind}": _with_defaults("fabrics", chosen_fabric(choice, kind)) for kind in garment_kinds}


def _with_defaults(kind: str, spec: ComponentSpec) -> ComponentSpec:
    # The name keeps its argument, ``litellm:openai/gpt-4o``, which is one of the parameters too.
    return ComponentSpec(name=spec.name, params=dict(parameters(kind, spec)))
