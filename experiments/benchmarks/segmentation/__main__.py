"""Measure how well cloth is told from the table on photographs.

    python -m experiments.benchmarks.segmentation [--n 40] [--first-seed 0] [--data DIR] [--sheet PNG]

Scenes are drawn: wood, marble, shadows, a hand at the edge, patterned cloth, sun spots and a cable take turns.
``--data DIR`` draws outlines of real garments (aRTF Clothes, one JSON object a line) instead of generated ones. The
contact sheet shows every scene with the outline that ``photo`` found, green where it is right.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from tqdm import tqdm

from experiments.benchmarks.segmentation.measuring import (
    SEGMENTERS,
    Measured,
    measure,
    real_outlines,
    takes_empty_table,
)
from experiments.benchmarks.segmentation.scenes import KINDS, drawn_scene

GOOD = 0.95
"""An IoU below this is a failure."""

ROWS = 14
"""Real outlines taken of each kind of garment."""

ACROSS = 7
"""Pictures in a row of the contact sheet."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a markdown table, and draw the contact sheet."""
    description = "Measure how well cloth is told from the table on photographs."
    parser = argparse.ArgumentParser(prog="experiments.benchmarks.segmentation", description=description)
    parser.add_argument("--n", type=int, default=40, help="scenes (default: 40)")
    parser.add_argument("--first-seed", type=int, default=0, help="seed of the first scene (default: 0)")
    parser.add_argument("--data", type=Path, help="folder with real outlines to draw, one JSON object a line")
    parser.add_argument("--segmenter", nargs="*", default=list(SEGMENTERS), choices=SEGMENTERS, help="default: all")
    parser.add_argument("--sheet", type=Path, metavar="PNG", help="where to draw the scenes")
    options = parser.parse_args(arguments)
    outlines = real_outlines(options.data, ROWS) if options.data else []
    results, tiles, taken = list[Measured](), [], 0
    for seed in tqdm(range(options.first_seed, options.first_seed + options.n), disable=None, leave=False):
        scene = drawn_scene(seed, outlines)
        found = list(measure(seed, scene, options.segmenter))
        results += found
        taken += takes_empty_table(scene)
        tiles += [_tile(scene.rgb, result) for result in found if result.segmenter == "photo"]
    _print(results, options.segmenter)
    print(f"\nOf {options.n} empty tables `photo` takes {taken} for cloth.")
    if options.sheet and tiles:
        options.sheet.parent.mkdir(parents=True, exist_ok=True)
        _contact_sheet(tiles).save(options.sheet)


def _print(results: Sequence[Measured], segmenters: Sequence[str]) -> None:
    print("\n| IoU, mean | " + " | ".join(segmenters) + " |")
    print("|---" * (len(segmenters) + 1) + "|")
    for kind in (*KINDS, "all"):
        cells = []
        for name in segmenters:
            chosen = [r for r in results if r.segmenter == name and kind in (r.kind, "all")]
            cells.append(f"{np.mean([r.iou for r in chosen]):.3f}" if chosen else "–")
        count = len({r.seed for r in results if kind in (r.kind, "all")})
        print(f"| {kind} (n = {count}) | " + " | ".join(cells) + " |")
    rows: list[tuple[str, list[str]]] = [("lowest", []), (f"below {GOOD}", []), ("of these refused", [])]
    rows += [("of these with a doubt", []), ("CPU, median [s]", [])]
    for name in segmenters:
        chosen = [r for r in results if r.segmenter == name]
        bad = [r for r in chosen if r.iou < GOOD]
        values = (
            f"{min(r.iou for r in chosen):.3f}",
            str(len(bad)),
            str(sum(bool(r.refused) for r in bad)),
            str(sum(r.doubts > 0 for r in bad)),
            f"{np.median([r.seconds for r in chosen]):.2f}",
        )
        for (_, cells), value in zip(rows, values, strict=True):
            cells.append(value)
    for label, cells in rows:
        print(f"| {label} | " + " | ".join(cells) + " |")


def _tile(rgb: NDArray[np.uint8], result: Measured) -> Image.Image:
    """A scene at half its size, with the outline and the IoU."""
    from scipy import ndimage

    edge = np.asarray(ndimage.binary_dilation(result.mask, iterations=2), bool) & ~result.mask
    picture = rgb.copy()
    picture[edge] = (0, 220, 60) if result.iou >= GOOD else (255, 0, 200)
    tile = Image.fromarray(picture).resize((320, 240))
    text = f"{result.seed} {result.kind} " + ("refused" if result.refused else f"{result.iou:.3f}")
    draw = ImageDraw.Draw(tile)
    draw.rectangle((0, 0, 8 + 6 * len(text), 13), fill=(0, 0, 0))
    draw.text((4, 1), text, fill=(255, 255, 255))
    return tile


def _contact_sheet(tiles: Sequence[Image.Image]) -> Image.Image:
    width, height = tiles[0].size
    sheet = Image.new("RGB", (ACROSS * width, -(-len(tiles) // ACROSS) * height))
    for number, tile in enumerate(tiles):
        sheet.paste(tile, (number % ACROSS * width, number // ACROSS * height))
    return sheet


if __name__ == "__main__":
    main()
