"""``polyfold garments``: a picture sheet of seeded garments, as the camera sees them."""

from __future__ import annotations

import argparse
from pathlib import Path

__all__ = ["configure", "run"]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--garment", action="append", metavar="KIND", help="only this kind; may be repeated")
    parser.add_argument("--count", type=int, default=6, metavar="N", help="garments of each kind (default: 6)")
    parser.add_argument("--seed", type=int, default=0, help="first seed (default: 0)")
    parser.add_argument("--out", type=Path, default=Path("garments.png"), metavar="PNG", help="default: garments.png")


def run(arguments: argparse.Namespace) -> int:
    """Draw the sheet."""
    from polyfold import plugins, viz

    kinds = arguments.garment or plugins.names("garments")
    simulator = plugins.create("simulators", "xpbd")
    pictures = {}
    for kind in kinds:
        generator = plugins.create("garments", kind)
        for seed in range(arguments.seed, arguments.seed + arguments.count):
            garment = generator.generate(seed)
            pictures[garment.name] = simulator.reset(garment, seed).rgb
    simulator.close()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    viz.garment_sheet(pictures, columns=arguments.count, path=arguments.out)
    print(f"{len(pictures)} garments: {arguments.out}")
    return 0
