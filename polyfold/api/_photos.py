"""The garment in a photograph: found by a segmenter, measured by a sheet that lies beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import GarmentError
from polyfold.garments._outline_files import load_picture, outline_from_photo
from polyfold.geometry import Camera
from polyfold.geometry._homography import homography
from polyfold.geometry._rectified import Rectified, rectify
from polyfold.plugins.interfaces import Segmenter
from polyfold.types import Observation

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]

SEGMENTER = "photo"
"""What finds the cloth in a photograph by default: ``colour``, which suits the simulator, knows flat colours only."""

AROUND_SHEET = 0.02
"""Margin around a sheet that is painted over with it, as a share of the picture's longer side."""

BENT = 1.5
"""A board whose corners are off by more than this on average [px] is bent, or the lens distorts."""


@runtime_checkable
class Doubting(Protocol):
    """A segmenter that says what speaks against a mask."""

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """One line each."""
        ...


@dataclass(frozen=True, eq=False)
class Photo:
    """What was found in a photograph.

    Attributes:
        rgb: the photograph, uint8, shape (H, W, 3).
        outline: of the garment [px], shape (N, 2).
        plane: how its pixels map to metres on the table; None without a sheet.
        doubts: what speaks against the outline, as (factor on the confidence, words).
    """

    rgb: Picture
    outline: Floats
    plane: Rectified | None
    doubts: tuple[tuple[float, str], ...]


def look(path: str | Path, segmenter: str | dict[str, Any] | ComponentSpec | None, sheet: str | None) -> Photo:
    """Find the garment in a photograph.

    Args:
        path: PNG or JPEG file.
        segmenter: what finds it: a name, or a table with ``name`` and ``params``; by default ``photo``.
        sheet: what lies beside it and is of known size, such as ``a4``; None for nothing.

    Raises:
        GarmentError: if the file is no picture, or no garment or sheet is found.
        PluginError: if there is no such segmenter.
    """
    chosen = Experiment().override({"segmenter": segmenter or SEGMENTER})
    finder: Segmenter = plugins.create_chosen(chosen, "segmenter")
    rgb = load_picture(path)
    plane = None
    if sheet is not None:
        try:
            plane = rectify(rgb, sheet)
        except GarmentError as error:
            raise GarmentError(f"{path}: {error}") from error
    seen = list[tuple[Observation, Mask]]()

    def find(smaller: Picture) -> Mask:
        picture = smaller if plane is None else _without(smaller, plane.corners * (smaller.shape[1] / rgb.shape[1]))
        observation = observed(picture)
        mask = finder.segment(observation)
        seen.append((observation, mask))
        return mask

    outline = outline_from_photo(path, find)
    doubts = [(0.6, words) for words in finder.doubts(*seen[-1])] if isinstance(finder, Doubting) else []
    if plane is not None and plane.residual > BENT:
        words = f"the board's corners are off by {plane.residual:.1f} px: it is bent, or the lens distorts"
        doubts.append((0.8, words))
    return Photo(rgb, outline, plane, tuple(doubts))


def observed(picture: Picture) -> Observation:
    """A picture, uint8, shape (H, W, 3), as from a camera above a flat table."""
    height, width = picture.shape[:2]
    camera = Camera(width, height)
    return Observation(picture, np.full((height, width), camera.elevation, np.float32), camera)


def framed(photo: Picture, to_frame: Callable[[Floats], Floats], camera: Camera) -> Picture:
    """The part of a photograph that a camera's frame shows, uint8, shape (H, W, 3).

    Args:
        photo: uint8, shape (H, W, 3).
        to_frame: maps pixels of the photograph, shape (N, 2), to pixels of the frame: a homography.
        camera: whose frame it is.
    """
    import cv2

    height, width = photo.shape[:2]
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    # From a small square in the middle: farther out there may be a horizon.
    near = np.array([width, height]) * (0.45 + 0.1 * corners)
    seen = to_frame(near)
    matrix = homography(near, seen)
    size = (camera.width, camera.height)
    flags = cv2.INTER_AREA if np.ptp(seen, axis=0).max() < np.ptp(near, axis=0).max() else cv2.INTER_LINEAR
    return np.asarray(cv2.warpPerspective(photo, matrix, size, flags=flags, borderMode=cv2.BORDER_REPLICATE), np.uint8)


def _without(picture: Picture, corners: Floats) -> Picture:
    """The picture with a sheet painted over with what is around it, so that it is not taken for cloth."""
    import cv2

    margin = max(2, round(AROUND_SHEET * max(picture.shape)))
    hidden = np.zeros(picture.shape[:2], np.uint8)
    cv2.fillConvexPoly(hidden, np.round(corners).astype(np.int32), 1)
    hidden = cv2.dilate(hidden, np.ones((2 * margin + 1, 2 * margin + 1), np.uint8))
    return np.asarray(cv2.inpaint(picture, hidden, 3, cv2.INPAINT_TELEA), np.uint8)
