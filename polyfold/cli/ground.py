"""``polyfold ground``: fit the polygon model to a photo, mask or outline and show it."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import polyfold
from polyfold.api._photos import SEGMENTER
from polyfold.cli._options.components import add_component_options, experiment_from
from polyfold.cli._options.garment_source import add_sheet_option
from polyfold.config import ComponentSpec, Experiment

OUTLINES = {".json", ".jsonl"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "source", type=Path, help="photo of the garment on a table, black-and-white mask, or outline (JSON)"
    )
    parser.add_argument("--garment", required=True, metavar="KIND", help="kind of garment, for example tshirt")
    parser.add_argument("--out", type=Path, metavar="PNG", help="picture (default: SOURCE with -polygon.png)")
    parser.add_argument("--json", action="store_true", help="print the keypoints in the source's pixels as JSON")
    add_sheet_option(parser)
    add_component_options(parser, ["grounding", "segmenter"], {"segmenter": SEGMENTER})


def run(arguments: argparse.Namespace) -> int:
    """Fit, draw and report."""
    from polyfold import viz

    experiment = experiment_from(arguments)
    source = _source(arguments.source)
    segmenter = _segmenter(arguments) if "image" in source or arguments.segmenter else None
    found = polyfold.ground(
        arguments.garment, **source, segmenter=segmenter, sheet=arguments.sheet, experiment=experiment
    )
    out = arguments.out or Path(f"{arguments.source.stem}-polygon.png")
    out.parent.mkdir(parents=True, exist_ok=True)
    assert found.scene.model is not None
    viz.save(viz.grounding_picture(found.rgb, found.scene.model, arguments.source.name), out)
    keypoints = {name: [round(float(x), 1), round(float(y), 1)] for name, (x, y) in found.keypoints.items()}
    if arguments.json:
        report = {"keypoints": keypoints, "residual_px": round(found.scene.residual, 2), "picture": str(out)}
        told = {"confidence": round(found.confidence, 2), "doubts": list(found.doubts)}
        told |= {} if found.size is None else {"size_m": round(found.size, 4)}
        print(json.dumps({**report, **told, "notes": list(found.scene.notes)}))
        return 0
    print(f"confidence that this is a {arguments.garment}: {found.confidence:.2f}")
    for doubt in found.doubts:
        print(f"  doubt: {doubt}")
    print(f"mean distance between polygon and outline: {found.scene.residual:.1f} px at a span of 300 px")
    if found.size is not None:
        print(
            f"longest side of the upright {arguments.garment}: {found.size:.3f} m, by the {arguments.sheet} beside it"
        )
    for name, (x, y) in keypoints.items():
        print(f"  {name:<20} {x:8.1f} {y:8.1f}")
    for note in found.scene.notes:
        print(f"  note: {note}")
    print(f"picture: {out}")
    return 0


def _segmenter(arguments: argparse.Namespace) -> ComponentSpec:
    """What finds the cloth: as asked, as the configuration file says, or what suits photos."""
    named = arguments.segmenter or (
        arguments.config and "segmenter" in Experiment.load(arguments.config).model_fields_set
    )
    if not named:
        arguments.segmenter = SEGMENTER
    return experiment_from(arguments).segmenter


def _source(path: Path) -> dict[str, Path]:
    """What a file is: an outline by its ending, a mask if it is black and white, else a photo."""
    if path.suffix.lower() in OUTLINES:
        return {"outline": path}
    from polyfold.api._loaders import is_mask

    return {"mask": path} if is_mask(path) else {"image": path}
