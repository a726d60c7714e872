"""Boxes, points and strokes that say where the cloth is, as shares of the picture: the same at every resolution."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

Share = Annotated[float, Field(ge=0, le=1)]
Point = tuple[Share, Share]
Stroke = Annotated[tuple[Point, ...], Field(min_length=1)]


def _in_order(box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    left, top, right, bottom = box
    if right - left < 0.01 or bottom - top < 0.01:
        raise ValueError("a box reads left, top, right, bottom, as shares of the picture, and is not empty")
    return box


Box = Annotated[tuple[Share, Share, Share, Share], AfterValidator(_in_order)]
"""Left, top, right and bottom, as shares of the picture's width and height."""


def in_pixels(points: tuple[Point, ...], shape: tuple[int, int]) -> NDArray[np.int32]:
    """Points in pixels (x, y), shape (N, 2), of a picture of that shape (H, W)."""
    height, width = shape
    return np.round(np.array(points, float) * [width - 1, height - 1]).astype(np.int32)
