"""Options that choose components, shared by the verbs: ``--policy farthest``, ``--llm NAME:MODEL``, ``--set``."""

from __future__ import annotations

import argparse
import json
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from polyfold.config import USUAL, ComponentSpec, Experiment
from polyfold.errors import ConfigError

KINDS = tuple(name for name, field in Experiment.model_fields.items() if field.annotation is ComponentSpec)
MEANING = {USUAL: ", what the kind of garment is usually made of (see: polyfold garments)"}
GUIDANCE = get_args(Experiment.model_fields["guidance"].annotation)


def add_component_options(
    parser: argparse.ArgumentParser, kinds: Sequence[str] = KINDS, defaults: Mapping[str, str] | None = None
) -> None:
    """Add one option per kind of component that the verb uses, the config file and single parameters.

    Args:
        parser: of the verb.
        kinds: of component, singular.
        defaults: kind -> name of what the verb uses by default, where that is not what experiments do.
    """
    group = parser.add_argument_group("components (see: polyfold plugins)")
    for kind in kinds:
        default: str = (defaults or {}).get(kind) or getattr(Experiment(), kind).name
        default += MEANING.get(default, "")
        group.add_argument(f"--{kind}", metavar="NAME[:ARG]", help=f"default: {default}")
    if "agent" in kinds:
        default = Experiment().guidance
        group.add_argument("--guidance", choices=GUIDANCE, help=f"for agents that need guidance (default: {default})")
    group.add_argument("--config", metavar="FILE", help="TOML file with components and parameters")
    group.add_argument(
        "--set",
        metavar="KIND.PARAM=VALUE",
        action="append",
        default=[],
        help=f"one parameter, for example --set {_example(kinds)}; may be repeated",
    )
    parser.set_defaults(component_kinds=tuple(kinds))


def experiment_from(arguments: argparse.Namespace) -> Experiment:
    """The experiment that the options describe. Raises ConfigError naming the wrong option."""
    experiment = Experiment.load(arguments.config) if arguments.config else Experiment()
    given = {name: getattr(arguments, name, None) for name in (*KINDS, "guidance")}
    experiment = experiment.override({name: value for name, value in given.items() if value})
    for assignment in arguments.set:
        kind, param, value = _parse(assignment, arguments.component_kinds)
        spec: ComponentSpec = getattr(experiment, kind)
        experiment = experiment.override({kind: spec.with_parameter(param, value)})
    return experiment


def _example(kinds: Sequence[str]) -> str:
    return "fabric.thickness=0.002" if "fabric" in kinds else f"{kinds[0]}.PARAM=VALUE"


def _parse(assignment: str, kinds: Sequence[str]) -> tuple[str, str, Any]:
    path, equals, text = assignment.partition("=")
    kind, dot, param = path.partition(".")
    if not (equals and dot and kind in kinds):
        raise ConfigError(
            f"--set {assignment!r} does not read KIND.PARAM=VALUE with KIND one of {', '.join(kinds)}; "
            f"for example --set {_example(kinds)}"
        )
    return kind, param, _value(text)


def component(text: str) -> str | dict[str, Any]:
    """What a component is written as: ``NAME``, ``NAME:ARG`` or a table with ``name`` and ``params``."""
    value = _value(text) if text.lstrip().startswith("{") else text
    return value if isinstance(value, dict) else text


def _value(text: str) -> Any:
    """What is written as JSON or as TOML; anything else is a text."""
    try:
        return json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        pass
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        return text
