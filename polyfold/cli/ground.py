"""``polyfold ground``: fit the polygon model to a photo, mask or outline and show it."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import polyfold
from polyfold.cli._options.components import add_component_options, experiment_from

OUTLINES = {".json", ".jsonl"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "source", type=Path, help="photo on a plain background, black-and-white mask, or outline (JSON)"
    )
    parser.add_argument("--garment", required=True, metavar="KIND", help="kind of garment, for example tshirt")
    parser.add_argument("--out", type=Path, metavar="PNG", help="picture (default: SOURCE with -polygon.png)")
    parser.add_argument("--json", action="store_true", help="print the keypoints in the source's pixels as JSON")
    add_component_options(parser, ["grounding"])


def run(arguments: argparse.Namespace) -> int:
    """Fit, draw and report."""
    from polyfold import viz

    experiment = experiment_from(arguments)
    found = polyfold.ground(arguments.garment, **_source(arguments.source), experiment=experiment)
    out = arguments.out or Path(f"{arguments.source.stem}-polygon.png")
    out.parent.mkdir(parents=True, exist_ok=True)
    assert found.scene.model is not None
    viz.save(viz.grounding_picture(found.rgb, found.scene.model, arguments.source.name), out)
    keypoints = {name: [round(float(x), 1), round(float(y), 1)] for name, (x, y) in found.keypoints.items()}
    if arguments.json:
        report = {"keypoints": keypoints, "residual_px": round(found.scene.residual, 2), "picture": str(out)}
        told = {"confidence": round(found.confidence, 2), "doubts": list(found.doubts)}
        print(json.dumps({**report, **told, "notes": list(found.scene.notes)}))
        return 0
    print(f"confidence that this is a {arguments.garment}: {found.confidence:.2f}")
    for doubt in found.doubts:
        print(f"  doubt: {doubt}")
    print(f"mean distance between polygon and outline: {found.scene.residual:.1f} px at a span of 300 px")
    for name, (x, y) in keypoints.items():
        print(f"  {name:<20} {x:8.1f} {y:8.1f}")
    for note in found.scene.notes:
        print(f"  note: {note}")
    print(f"picture: {out}")
    return 0


def _source(path: Path) -> dict[str, Path]:
    """What a file is: an outline by its ending, a mask if it is black and white, else a photo."""
    if path.suffix.lower() in OUTLINES:
        return {"outline": path}
    from polyfold.api._loaders import is_mask

    return {"mask": path} if is_mask(path) else {"image": path}
