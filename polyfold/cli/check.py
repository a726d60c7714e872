"""``polyfold check``: whether a plugin does what its components promise."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from typing import Any

from polyfold.errors import ConfigError


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("name", help="of a plugin, its distribution or one component, such as 'policy caso'")
    parser.add_argument(
        "--params",
        metavar="JSON",
        default="{}",
        help="""parameters by component: '{"policy mine": {"file": "weights.safetensors"}}'""",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run every check; 1 if one finds a fault."""
    from polyfold.testing import check

    component, faults, count = "", 0, 0
    for found in check(arguments.name, _params(arguments.params)):
        if found.component != component:
            component = found.component
            print(f"{component}{f'  not tried: it {found.untried}' if found.untried else ''}")
        if found.untried:
            continue
        print(f"  {'✗' if found.fault else '✓'} {found.says}", flush=True)
        if found.fault:
            print(f"      {found.fault}")
        count, faults = count + 1, faults + (found.fault is not None)
    print(f"{count} checks, {faults} {'fault' if faults == 1 else 'faults'}")
    return 1 if faults else 0


def _params(text: str) -> Mapping[str, Mapping[str, Any]]:
    try:
        params = json.loads(text)
    except ValueError as error:
        raise ConfigError(f'--params is no JSON ({error}); quote it: \'{{"policy mine": {{"arms": 1}}}}\'') from error
    if not isinstance(params, dict) or not all(isinstance(values, dict) for values in params.values()):
        raise ConfigError('--params holds one table a component: \'{"policy mine": {"arms": 1}}\'')
    return params
