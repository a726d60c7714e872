"""Fits to hand-annotated outlines of real garments (aRTF Clothes, see the data's README), against its keypoints."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from polyfold_standard.templates import shorts_template, towel_template, tshirt_template
from tqdm import tqdm

from polyfold.errors import ConfigError, did_you_mean
from polyfold.geometry import Camera
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins.interfaces import Grounding
from polyfold.polygon import Template
from polyfold.types import Observation

Floats = NDArray[np.float64]

SPAN, SIZE = 300.0, 400
"""The outline's bounding box measures 300 px along its longer side, in an image of 400 x 400 px."""

SIDES = ("left", "right")


@dataclass(frozen=True)
class Dataset:
    """How one file is read.

    Attributes:
        file: file name.
        template: makes the template.
        vertices: keypoint name in the file -> vertex name; empty where keypoints have no names of their own.
    """

    file: str
    template: Callable[[], Template]
    vertices: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class RealResult:
    """One garment: keypoint errors [px], shape (K,), and CPU time [s]."""

    errors: Floats
    seconds: float


def _tshirt_names() -> dict[str, str]:
    same = [f"{name}_{side}" for name in ("armpit", "shoulder", "neck") for side in SIDES]
    names = {name: name for name in same} | {f"waist_{side}": f"hem_{side}" for side in SIDES}
    return names | {f"sleeve_{side}_{end}": f"sleeve_{end}_{side}" for side in SIDES for end in ("top", "bottom")}


def _shorts_names() -> dict[str, str]:
    legs = {f"pipe_{side}_{edge}": f"leg_{edge}_{side}" for side in SIDES for edge in ("inner", "outer")}
    return legs | {name: name for name in ("waist_left", "waist_right", "crotch")}


DATASETS = {
    "tshirt": Dataset("tshirts-train.jsonl", tshirt_template, _tshirt_names()),
    "towel": Dataset("towels-train.jsonl", towel_template, {}),
    "shorts": Dataset("shorts-train.jsonl", shorts_template, _shorts_names()),
}


def measure_real(kind: str, folder: Path, rows: str, grounding: Grounding) -> list[RealResult]:
    """Fit the ``even``, ``odd`` or ``all`` rows of one kind of garment."""
    if kind not in DATASETS:
        raise ConfigError(f"there is no real data for {kind!r}; {did_you_mean(kind, DATASETS)}")
    dataset = DATASETS[kind]
    template = dataset.template()
    lines = (folder / dataset.file).read_text("utf-8").splitlines()
    chosen = {"even": lines[0::2], "odd": lines[1::2], "all": lines}[rows]
    results = []
    for line in tqdm(chosen, desc=f"{kind}, real", leave=False):
        mask, keypoints = rasterised(json.loads(line))
        drawn = _drawn(mask)
        if not results:  # the first call compiles
            grounding.ground(drawn, mask, template)
        clock = time.process_time()
        model = grounding.ground(drawn, mask, template).model
        seconds = time.process_time() - clock
        assert model is not None
        results.append(RealResult(_errors(template, model.rest, keypoints, dataset.vertices), seconds))
    return results


def rasterised(row: Mapping[str, Any]) -> tuple[NDArray[np.bool_], dict[str, Floats]]:
    """Mask, shape (400, 400), and keypoints [px] of one annotation, scaled and centred."""
    polygons = [np.array(polygon, float) for polygon in row["mask"] if len(polygon) >= 3]
    corners = np.vstack(polygons)
    low, high = corners.min(0), corners.max(0)
    scale = SPAN / (high - low).max()
    shift = SIZE / 2 - scale * (low + high) / 2
    mask = np.zeros((SIZE, SIZE), bool)
    for polygon in polygons:
        mask |= fill_polygon(polygon * scale + shift, SIZE, SIZE)
    return mask, {name: np.array(point) * scale + shift for name, point in row["keypoints"].items()}


def _drawn(mask: NDArray[np.bool_]) -> Observation:
    """The picture of a mask, shape (400, 400), under the usual camera."""
    camera = Camera(width=SIZE, height=SIZE)
    rgb = np.repeat(np.where(mask, 0, 255).astype(np.uint8)[..., None], 3, axis=2)
    return Observation(rgb, np.full(mask.shape, camera.elevation, np.float32), camera)


def _errors(template: Template, found: Floats, keypoints: Mapping[str, Floats], names: Mapping[str, str]) -> Floats:
    """Errors under the best of the allowed renamings: a swap of sides, or for towels any rotation and reflection."""
    if names:
        vertices = dict(zip(template.names, found, strict=True))
        known = [name for name in names if name in keypoints]
        pairs = [[(names[name], keypoints[name]) for name in known]]
        pairs.append([(_other_side(vertex), point) for vertex, point in pairs[0]])
        options = [np.array([np.hypot(*(vertices[v] - point)) for v, point in option]) for option in pairs]
    else:
        truth = np.array([keypoints[name] for name in sorted(keypoints)])
        turned = [np.roll(order, k, axis=0) for order in (found, found[::-1]) for k in range(len(found))]
        options = [np.hypot(*(option - truth).T) for option in turned]
    return min(options, key=np.mean)


def _other_side(name: str) -> str:
    if "left" in name:
        return name.replace("left", "right")
    return name.replace("right", "left")
