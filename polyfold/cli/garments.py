"""``polyfold garments``: a picture sheet of seeded garments, as the camera sees them."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold
from polyfold import plugins
from polyfold.cli._components import add_component_options, experiment_from


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--garment", action="append", metavar="KIND", help="only this kind; may be repeated")
    parser.add_argument("--count", type=int, default=6, metavar="N", help="garments of each kind (default: 6)")
    parser.add_argument("--seed", type=int, default=0, help="first seed (default: 0)")
    parser.add_argument("--out", type=Path, default=Path("garments.png"), metavar="PNG", help="default: garments.png")
    add_component_options(parser, ["simulator"])


def run(arguments: argparse.Namespace) -> int:
    """Draw the sheet."""
    from polyfold import viz

    simulator = plugins.create_chosen(experiment_from(arguments), "simulator")
    pictures = {}
    for kind in arguments.garment or plugins.names("garments"):
        for seed in range(arguments.seed, arguments.seed + arguments.count):
            garment = polyfold.garment(kind, seed)
            pictures[garment.name] = simulator.reset(garment, seed).rgb
    simulator.close()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    viz.garment_sheet(pictures, columns=arguments.count, path=arguments.out)
    print(f"{len(pictures)} garments: {arguments.out}")
    return 0
