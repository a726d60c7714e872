"""Segmenters on drawn scenes: IoU with what was drawn, what was refused, and how long it took."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from experiments.benchmarks.segmentation.scenes import DrawnScene
from polyfold import plugins
from polyfold.errors import PolyfoldError
from polyfold.garments import find_cloth
from polyfold.geometry import Camera, iou
from polyfold.types import Observation

Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]

SEGMENTERS = ("plain", "photo", "grabcut", "grabcut with a box", "background")
"""``plain`` is what photos were searched with before: one threshold on the distance from the border's colour."""

MARGIN = 0.03
"""Of the box that ``grabcut with a box`` is given around the garment, as a share of the picture."""


@dataclass(frozen=True, eq=False)
class Measured:
    """One segmenter on one scene.

    Attributes:
        seed: of the scene.
        kind: of the scene.
        segmenter: one of SEGMENTERS.
        mask: what it found, bool, shape (H, W); empty if it refused.
        iou: with the truth; 0 if it refused.
        refused: what it said, or nothing.
        doubts: how many it mentions.
        seconds: CPU time.
    """

    seed: int
    kind: str
    segmenter: str
    mask: Mask
    iou: float
    refused: str
    doubts: int
    seconds: float


def measure(seed: int, scene: DrawnScene, segmenters: Sequence[str]) -> Iterator[Measured]:
    """Run segmenters on one scene."""
    with TemporaryDirectory() as folder:
        Image.fromarray(scene.empty).save(Path(folder) / "empty.png")
        for name in segmenters:
            finder, doubts = _finder(name, scene, Path(folder) / "empty.png")
            clock = time.process_time()
            try:
                mask, refused = finder(scene.rgb), ""
            except PolyfoldError as error:
                mask, refused = np.zeros_like(scene.mask), str(error)
            seconds = time.process_time() - clock
            found = 0.0 if refused else iou(mask, scene.mask)
            mentioned = 0 if refused else doubts(scene.rgb, mask)
            yield Measured(seed, scene.kind, name, mask, found, refused, mentioned, seconds)


def takes_empty_table(scene: DrawnScene) -> bool:
    """Whether ``photo`` finds cloth on the scene's empty table."""
    try:
        plugins.create("segmenters", "photo").segment(_observed(scene.empty))
    except PolyfoldError:
        return False
    return True


def real_outlines(folder: Path, rows: int) -> list[NDArray[np.float64]]:
    """The first odd rows of each file of outlines in a folder (aRTF Clothes, see the data's README), [px]."""
    found = []
    for file in sorted(folder.glob("*.jsonl")):
        for line in file.read_text("utf-8").splitlines()[1::2][:rows]:
            found.append(np.array(max(json.loads(line)["mask"], key=len), float))
    return found


def _finder(
    name: str, scene: DrawnScene, empty: Path
) -> tuple[Callable[[Picture], Mask], Callable[[Picture, Mask], int]]:
    if name == "plain":
        return find_cloth, lambda rgb, mask: 0
    component, _, boxed = name.partition(" ")
    params = {"picture": str(empty)} if component == "background" else {"box": _box(scene.mask)} if boxed else {}
    segmenter = plugins.create("segmenters", component, params)
    return (
        lambda rgb: segmenter.segment(_observed(rgb)),
        lambda rgb, mask: len(segmenter.doubts(_observed(rgb), mask)),
    )


def _observed(rgb: Picture) -> Observation:
    height, width = rgb.shape[:2]
    camera = Camera(width, height)
    return Observation(rgb, np.full((height, width), camera.elevation, np.float32), camera)


def _box(mask: Mask) -> list[float]:
    """A box around a mask, as shares of the picture."""
    edges = [np.flatnonzero(mask.any(axis=axis)) / mask.shape[1 - axis] for axis in (0, 1)]
    low = [max(0.0, float(edge[0]) - MARGIN) for edge in edges]
    high = [min(1.0, float(edge[-1]) + MARGIN) for edge in edges]
    return [*low, *high]
