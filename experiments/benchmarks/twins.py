"""Twins of real garments folded in half: ``python -m polyfold.benchmark.twins --data DIR``.

The odd rows of the aRTF Clothes outlines (``tshirts-train.jsonl``, ``towels-train.jsonl``; DOI
10.5281/zenodo.10875542) become simulated twins, which are folded from a sentence. Judged against the ideal along the
twin's own keypoints. Leaves a picture sheet; the run directory can be killed and resumed.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from polyfold.config import Experiment
from polyfold.errors import PolyfoldError
from polyfold.logs import RunDirectory

SETS = {
    "tshirts": ("tshirt", "fold the t-shirt in half from left to right"),
    "towels": ("rectangle", "fold the left edge onto the right edge"),
}
"""File name -> garment kind and instruction."""


def main(arguments: list[str] | None = None) -> None:
    """Run what is missing, print the table, draw the sheets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with the aRTF outlines")
    parser.add_argument("--n", type=int, default=20, help="rows of each set (default: 20)")
    parser.add_argument("--rows", choices=["odd", "even"], default="odd", help="report on odd rows, develop on even")
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark-twins"), help="run directory, resumed")
    chosen = parser.parse_args(arguments)
    run = RunDirectory(chosen.out, {"benchmark": "twins", "rows": chosen.rows})
    print("| garments | n | IoU, mean | lowest | moved-part error, mean [mm] | failures |\n|---|---|---|---|---|---|")
    for name in SETS:
        rows = (chosen.data / f"{name}-train.jsonl").read_text("utf-8").splitlines()[chosen.rows == "odd" :: 2]
        _complete(run, name, rows[: chosen.n])
        records = [record for key, record in run.episodes().items() if key.startswith(f"{name}/")]
        print(_line(name, records), flush=True)
        _sheet(run.path, name, records)


def _complete(run: RunDirectory, name: str, rows: list[str]) -> None:
    from tqdm import tqdm

    done = run.episodes()
    for number, row in enumerate(tqdm(rows, desc=name, unit="garment")):
        key = f"{name}/{number}"
        if key not in done:
            run.append(key, _twin(name, json.loads(row), run.path / f"{name}-{number:02}.png"))


def _twin(name: str, row: dict[str, Any], picture: Path) -> dict[str, Any]:
    """Fold one twin; the picture shows the grounded outline beside the result."""
    from polyfold import viz
    from polyfold.api import attempt, garment, ground
    from polyfold.geometry import polygon_area

    kind, instruction = SETS[name]
    outline = max((np.asarray(polygon) for polygon in row["mask"]), key=lambda polygon: abs(polygon_area(polygon)))
    try:
        found = ground(kind, outline=outline)
        twin = garment(kind, outline=outline)
    except PolyfoldError as error:
        return {"image": row["image"], "failure": {"stage": "twin", "reason": str(error)}}
    episode = attempt(instruction, twin, 0, Experiment())
    panels = [viz.overlay(found.rgb, found.scene), episode.start.rgb, episode.show_result()]
    viz.save(np.hstack(panels), picture)
    return {"image": row["image"], "picture": picture.name, **episode.summary()}


def _line(name: str, records: list[dict[str, Any]]) -> str:
    folded = [record for record in records if record.get("fidelity")]
    iou = np.array([record["fidelity"]["iou"] for record in folded])
    error = np.array([record["fidelity"]["moved_part_error_mm"] for record in folded])
    failures = sum(record["failure"] is not None for record in records)
    return f"| {name} | {len(records)} | {iou.mean():.3f} | {iou.min():.3f} | {error.mean():.1f} | {failures} |"


def _sheet(folder: Path, name: str, records: list[dict[str, Any]]) -> None:
    from PIL import Image

    from polyfold import viz

    cards = []
    for number, record in enumerate(records):
        if "picture" not in record:
            continue
        pixels = np.asarray(Image.open(folder / record["picture"]).convert("RGB"))
        panels = np.split(pixels, 3, axis=1)
        fidelity = record["fidelity"]
        caption = f"IoU {fidelity['iou']:.3f}, {fidelity['moved_part_error_mm']:.0f} mm"
        cards.append(viz.Card(panels, f"{name} {number}", caption))
    viz.score_sheet(cards, f"aRTF {name}: outline, twin, folded", folder / f"{name}.png", columns=3, side=150)


if __name__ == "__main__":
    main()
