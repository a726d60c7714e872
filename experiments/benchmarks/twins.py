"""Fold twins of real garments in half: ``python -m experiments.benchmarks.twins --data DIR``.

The odd rows of the aRTF Clothes outlines (``tshirts-train.jsonl``, ``towels-train.jsonl``; DOI
10.5281/zenodo.10875542) become simulated twins, which are folded from a sentence. Judged against the ideal along the
twin's own keypoints. Leaves a picture sheet; the run directory can be killed and resumed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from tqdm import tqdm

from polyfold import viz
from polyfold.api import attempt, garment, ground
from polyfold.config import Experiment
from polyfold.errors import PolyfoldError
from polyfold.geometry import polygon_area
from polyfold.logs import FoldRecord, RunDirectory, exclusive
from polyfold.logs._records import KeyedRecord
from polyfold.logs._writing import fold_record

SETS = {
    "tshirts": ("tshirt", "fold the t-shirt in half from left to right"),
    "towels": ("rectangle", "fold the left edge onto the right edge"),
}
"""File name -> garment kind and instruction."""


class TwinRecord(KeyedRecord):
    """One real garment.

    Attributes:
        image: the photograph that the outline was drawn on.
        picture: file name of the outline beside the twin, flat and folded.
        episode: how the twin was folded.
        problem: why there is no twin; None if there is one.
    """

    image: str
    picture: str | None = None
    episode: FoldRecord | None = None
    problem: str | None = None

    @property
    def failed(self) -> bool:
        """Whether there is no twin, or it could not be folded."""
        return self.episode is None or self.episode.failure is not None


def main(arguments: list[str] | None = None) -> None:
    """Run what is missing, print the table, draw the sheets."""
    parser = argparse.ArgumentParser(description="Fold twins of real garments in half.")
    parser.add_argument("--data", type=Path, required=True, help="folder with the aRTF outlines")
    parser.add_argument("--n", type=int, default=20, help="rows of each set (default: 20)")
    parser.add_argument("--rows", choices=["odd", "even"], default="odd", help="report on odd rows, develop on even")
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark-twins"), help="run directory, resumed")
    chosen = parser.parse_args(arguments)
    with exclusive(chosen.out):
        _report(RunDirectory(chosen.out, {"benchmark": "twins", "rows": chosen.rows}, TwinRecord), chosen)


def _report(run: RunDirectory[TwinRecord], chosen: argparse.Namespace) -> None:
    print("| garments | n | IoU, mean | lowest | moved-part error, mean [mm] | failures |\n|---|---|---|---|---|---|")
    for name in SETS:
        rows = (chosen.data / f"{name}-train.jsonl").read_text("utf-8").splitlines()[chosen.rows == "odd" :: 2]
        _complete(run, name, rows[: chosen.n])
        records = [record for key, record in run.records().items() if key.startswith(f"{name}/")]
        print(_line(name, records), flush=True)
        _sheet(run.path, name, records)


def _complete(run: RunDirectory[TwinRecord], name: str, rows: Sequence[str]) -> None:
    done = run.records()
    for number, row in enumerate(tqdm(rows, desc=name, unit="garment")):
        key = f"{name}/{number}"
        if key not in done:
            run.append(_twin(key, name, json.loads(row), run.path / f"{name}-{number:02}.png"))


def _twin(key: str, name: str, row: dict[str, Any], picture: Path) -> TwinRecord:
    """Fold one twin; the picture shows the grounded outline beside the result."""
    kind, instruction = SETS[name]
    outline = max((np.asarray(polygon) for polygon in row["mask"]), key=lambda polygon: abs(polygon_area(polygon)))
    try:
        found = ground(kind, outline=outline)
        twin = garment(kind, outline=outline)
    except PolyfoldError as error:
        return TwinRecord(key=key, image=row["image"], problem=str(error))
    episode = attempt(instruction, twin, 0, Experiment())
    panels = [viz.overlay(found.rgb, found.scene), episode.start.rgb, episode.show_result()]
    viz.save(np.hstack(panels), picture)
    return TwinRecord(key=key, image=row["image"], picture=picture.name, episode=fold_record(episode))


def _line(name: str, records: Sequence[TwinRecord]) -> str:
    judged = [record.episode.fidelity for record in records if record.episode and record.episode.fidelity]
    iou = np.array([fidelity.iou for fidelity in judged])
    error = np.array([fidelity.moved_part_error_mm for fidelity in judged], float)
    failures = sum(record.failed for record in records)
    return f"| {name} | {len(records)} | {iou.mean():.3f} | {iou.min():.3f} | {error.mean():.1f} | {failures} |"


def _sheet(folder: Path, name: str, records: Sequence[TwinRecord]) -> None:
    cards = []
    for number, record in enumerate(records):
        if record.picture is None or record.episode is None or record.episode.fidelity is None:
            continue
        pixels = np.asarray(Image.open(folder / record.picture).convert("RGB"))
        panels = np.split(pixels, 3, axis=1)
        iou, error = record.episode.fidelity.iou, record.episode.fidelity.moved_part_error_mm
        caption = f"IoU {iou:.3f}" + ("" if error is None else f", {error:.0f} mm")
        cards.append(viz.Card(panels, f"{name} {number}", caption))
    viz.score_sheet(cards, f"aRTF {name}: outline, twin, folded", folder / f"{name}.png", columns=3, side=150)


if __name__ == "__main__":
    main()
