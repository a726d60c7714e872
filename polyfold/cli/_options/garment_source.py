"""Options that say which garment: a seeded one, or the twin of a real one."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--garment", default="tshirt", metavar="KIND", help="kind of garment (default: tshirt)")
    parser.add_argument("--seed", type="seed", default=0, help="which garment and how it lies (default: 0)")
    parser.add_argument("--edge-length", type="metres", metavar="METRES", help="mesh size (default: by kind)")
    twin = parser.add_argument_group("a real garment instead of a seeded one")
    source = twin.add_mutually_exclusive_group()
    source.add_argument("--mask", type=Path, metavar="PNG", help="mask of the garment: a simulated twin is built")
    source.add_argument("--outline", type=Path, metavar="JSON", help="outline of the garment [[x, y], ...] in pixels")
    source.add_argument("--image", type=Path, metavar="PHOTO", help="photo of the garment on a plain background")
    source.add_argument("--mesh", type=Path, metavar="OBJ", help="triangle mesh; give --keypoints too")
    twin.add_argument("--keypoints", type=Path, metavar="JSON", help="keypoint name -> vertex index of the mesh")
    twin.add_argument("--size", type="metres", metavar="METRES", help="longest side of the real garment's bounding box")


def garment_from(arguments: argparse.Namespace, experiment: polyfold.Experiment) -> polyfold.Garment:
    """The garment that the options describe. Raises GarmentError or GroundingError with what to do."""
    return polyfold.garment(
        arguments.garment,
        seed=arguments.seed,
        mask=arguments.mask,
        outline=arguments.outline,
        image=arguments.image,
        mesh=arguments.mesh,
        keypoints=arguments.keypoints,
        size=arguments.size,
        edge_length=arguments.edge_length,
        experiment=experiment,
    )
