"""``polyfold table``: the results of an evaluation as a table."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold
from polyfold.analysis import provider_table
from polyfold.analysis._tables import FORMATS
from polyfold.errors import ConfigError


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("out", type=Path, metavar="DIR", help="run directory of an evaluation")
    parser.add_argument("--format", choices=FORMATS, default="markdown", help="default: markdown")
    parser.add_argument(
        "--by",
        choices=["kind", "type", "task", "split", "wording", "step", "none", "provider"],
        default="kind",
        help="default: kind; provider compares variants as language models, with validity, latency, tokens and cost",
    )
    parser.add_argument("--steps", choices=["single", "multi"], help="only tasks of one fold, or of several")
    parser.add_argument(
        "--wordings",
        metavar="unseen|seen|N,…",
        help="only sentences that nothing was tuned on, only the others, or those of these numbers",
    )
    parser.add_argument("--compare", nargs=2, metavar=("VARIANT", "BASELINE"), help="paired differences instead")
    parser.add_argument(
        "--noise-floor", type=Path, metavar="DIR", help="run directory of experiments/noise_floor.toml; a footnote"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the table."""
    found = polyfold.open(arguments.out)
    if not found.records:
        raise ConfigError(f"no episode in {arguments.out} is finished; go on with 'polyfold evaluate' of its study")
    found = found.of_length(arguments.steps) if arguments.steps else found
    found = found.of_wordings(_numbers_in(arguments.wordings)) if arguments.wordings else found
    noise = None if arguments.noise_floor is None else polyfold.open(arguments.noise_floor)
    if arguments.compare and arguments.by in ("step", "provider"):
        raise ConfigError(f"differences are not made by {arguments.by}; leave out --by, or --compare")
    if arguments.compare:
        made = polyfold.compare(found, *arguments.compare)
    elif arguments.by == "provider":
        made = provider_table(found)
    else:
        made = polyfold.table(found, groups=arguments.by, noise=noise)
    print(getattr(made, arguments.format)())
    return 0


def _numbers_in(wordings: str) -> str | frozenset[int]:
    """``3,4`` as numbers; what is none as it is."""
    numbers = wordings.split(",")
    return frozenset(map(int, numbers)) if all(number.strip().isdecimal() for number in numbers) else wordings
