"""``polyfold check``: whether a plugin does what its components promise."""

from __future__ import annotations

import argparse
import json
from collections import Counter
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

    here: set[str] = set()
    component, faults, count = "", Counter[str](), 0
    for found in check(arguments.name, _params(arguments.params)):
        if found.component != component:
            component, here = found.component, set()
            print(f"{component}{f'  not tried: it {found.untried}' if found.untried else ''}")
        if found.untried:
            continue
        print(f"  {'✗' if found.fault else '✓'} {found.says}", flush=True)
        count += 1
        if found.fault:
            print("      the same as above" if found.fault in here else f"      {found.fault}", flush=True)
            here.add(found.fault)
            faults[found.fault] += 1
    print(f"{count} checks, {_counted(faults)}")
    return 1 if faults else 0


def _counted(faults: Counter[str]) -> str:
    """How many checks found something wrong, and how much of that is different."""
    total, different = faults.total(), len(faults)
    said = f"{total} {'fault' if total == 1 else 'faults'}"
    return (
        said
        if total == different
        else f"{said}, {different} of them different"
        if different > 1
        else f"{said}, all the same"
    )


def _params(text: str) -> Mapping[str, Mapping[str, Any]]:
    try:
        params = json.loads(text)
    except ValueError as error:
        raise ConfigError(f'--params is no JSON ({error}); quote it: \'{{"policy mine": {{"arms": 1}}}}\'') from error
    if not isinstance(params, dict) or not all(isinstance(values, dict) for values in params.values()):
        raise ConfigError('--params holds one table a component: \'{"policy mine": {"arms": 1}}\'')
    return params
