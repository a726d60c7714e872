"""Options that choose components, shared by the verbs: ``--policy caso``, ``--llm NAME:MODEL``, ``--set``."""

from __future__ import annotations

import argparse
import json
from typing import Any

from polyfold import config
from polyfold.errors import ConfigError

__all__ = ["add_component_options", "experiment_from"]

FIELDS = ("agent", "simulator", "segmenter", "grounding", "planner", "policy", "llm")


def add_component_options(parser: argparse.ArgumentParser) -> None:
    """Add one option per kind of component, the config file and single parameters."""
    group = parser.add_argument_group("components (see: polyfold plugins)")
    for field in FIELDS:
        default = config.Experiment().model_dump()[field]["name"]
        group.add_argument(f"--{field}", metavar="NAME[:ARG]", help=f"default: {default}")
    group.add_argument("--guidance", choices=["steps", "final"], help="for agents that need guidance (default: steps)")
    group.add_argument("--config", metavar="FILE", help="TOML file with components and parameters")
    group.add_argument(
        "--set",
        metavar="KIND.PARAM=VALUE",
        action="append",
        default=[],
        help="one parameter, for example --set simulator.cloth_friction=0.6; may be repeated",
    )


def experiment_from(arguments: argparse.Namespace) -> config.Experiment:
    """The experiment that the options describe. Raises ConfigError naming the wrong option."""
    experiment = config.load(arguments.config) if arguments.config else config.Experiment()
    chosen = {field: getattr(arguments, field) for field in (*FIELDS, "guidance") if getattr(arguments, field)}
    experiment = experiment.override(chosen)
    for assignment in arguments.set:
        field, param, value = _parse(assignment)
        choice = getattr(experiment, field)
        experiment = experiment.override({field: {"name": choice.name, "params": {**choice.params, param: value}}})
    return experiment


def _parse(assignment: str) -> tuple[str, str, Any]:
    path, equals, text = assignment.partition("=")
    field, dot, param = path.partition(".")
    if not (equals and dot and field in FIELDS):
        raise ConfigError(
            f"--set {assignment!r} does not read KIND.PARAM=VALUE with KIND one of {', '.join(FIELDS)}; "
            "for example --set simulator.cloth_friction=0.6"
        )
    try:
        return field, param, json.loads(text)
    except json.JSONDecodeError:
        return field, param, text
