"""Options that say which garment: a seeded one, or the twin of a real one."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold
from polyfold.api._photos import SEGMENTER
from polyfold.cli._options.components import component
from polyfold.geometry._rectified import SHEETS


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--garment", default="tshirt", metavar="KIND", help="kind of garment (default: tshirt)")
    parser.add_argument("--seed", type="seed", default=0, help="which garment and how it lies (default: 0)")
    parser.add_argument("--edge-length", type="metres", metavar="METRES", help="mesh size (default: by kind)")
    twin = parser.add_argument_group("a real garment instead of a seeded one")
    source = twin.add_mutually_exclusive_group()
    source.add_argument("--mask", type=Path, metavar="PNG", help="mask of the garment: a simulated twin is built")
    source.add_argument("--outline", type=Path, metavar="JSON", help="outline of the garment [[x, y], ...] in pixels")
    source.add_argument("--image", type=Path, metavar="PHOTO", help="photo of the garment on a table")
    source.add_argument("--mesh", type=Path, metavar="OBJ", help="triangle mesh; give --keypoints too")
    twin.add_argument(
        "--photo-segmenter",
        type=component,
        metavar="NAME[:ARG]",
        help=f"what finds the cloth in PHOTO, or {{name = ..., params = {{...}}}} (default: {SEGMENTER})",
    )
    add_sheet_option(twin)
    twin.add_argument("--keypoints", type=Path, metavar="JSON", help="keypoint name -> vertex index of the mesh")
    twin.add_argument("--size", type="metres", metavar="METRES", help="longest side of the garment's bounding box")


def add_sheet_option(parser: argparse._ActionsContainer) -> None:
    """Add ``--sheet``."""
    parser.add_argument(
        "--sheet",
        metavar="SHEET",
        help=f"what lies beside the garment in the photo and measures it: {', '.join(SHEETS)}, or a ChArUco board as "
        "charuco:COLUMNSxROWS:SQUARE:MARKER [mm]; the photo may then be taken at an angle",
    )


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
        segmenter=arguments.photo_segmenter,
        sheet=arguments.sheet,
        experiment=experiment,
    )
