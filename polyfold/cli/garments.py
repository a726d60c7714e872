"""``polyfold garments``: a picture sheet of seeded garments as they lie, and what they are made of."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold
from polyfold import plugins
from polyfold.cli._options.components import add_component_options, experiment_from
from polyfold.plugins._fabrics import default_fabric


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--garment", action="append", metavar="KIND", help="only this kind; may be repeated")
    parser.add_argument("--count", type="count", default=6, metavar="N", help="garments of each kind (default: 6)")
    parser.add_argument("--seed", type="seed", default=0, help="first seed (default: 0)")
    parser.add_argument("--out", type=Path, default=Path("garments.png"), metavar="PNG", help="default: garments.png")
    add_component_options(parser, ["simulator", "fabric"])


def run(arguments: argparse.Namespace) -> int:
    """Draw the sheet."""
    from polyfold.viz._draw._cloth import cloth_picture
    from polyfold.viz._draw._sheets import garment_sheet

    experiment = experiment_from(arguments)
    simulator = plugins.create_chosen(experiment, "simulator")
    pictures = {}
    kinds = arguments.garment or plugins.names("garments")
    for kind in kinds:
        for seed in range(arguments.seed, arguments.seed + arguments.count):
            garment = polyfold.garment(kind, seed, experiment=experiment)
            seen, state = simulator.reset(garment, seed), simulator.state()
            pictures[garment.name] = cloth_picture(state, garment, zoom=1.0) if state.known else seen.rgb
    simulator.close()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    garment_sheet(pictures, columns=arguments.count, path=arguments.out)
    print(f"{len(pictures)} garments: {arguments.out}")
    for kind in kinds:
        made_of = plugins.make_fabric(experiment.fabric, kind).name
        usually = default_fabric(kind)
        print(f"  {kind:<16} {made_of}" + ("" if made_of == usually else f" (usually {usually})"))
    return 0
