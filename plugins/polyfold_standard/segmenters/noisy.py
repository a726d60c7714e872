"""The segmenter ``noisy``: another segmenter whose outline is wrong, so that what is robust to it can be told."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GroundingError
from polyfold.plugins import create
from polyfold.plugins.interfaces import Segmenter
from polyfold.types import Observation

Mask = NDArray[np.bool_]


class NoisySegmenter:
    """Segments as another does, then lets the outline waver, tears it and makes it coarse.

    What is drawn follows from the mask: the same picture is segmented alike each time.
    """

    class Config(BaseModel):
        """Parameters; with none given the mask stays as it is."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        inner: str = Field(default="colour", description="the segmenter whose masks are spoilt")
        inner_params: dict[str, Any] = Field(default_factory=dict, description="its parameters")
        edge_px: float = Field(default=0.0, ge=0, le=50, description="how far the outline wavers, RMS [px]")
        length_px: float = Field(default=12.0, gt=0, le=200, description="length of its waves [px]")
        tears: int = Field(default=0, ge=0, le=50, description="notches bitten out of the edge")
        tear_px: float = Field(default=8.0, gt=0, le=50, description="their radius [px]")
        coarse_px: int = Field(default=1, ge=1, le=50, description="side of the squares that the mask is made of [px]")

    @classmethod
    def reference_config(cls, config: Config) -> tuple[str, dict[str, Any]]:
        """The segmenter that results are measured by: the one whose masks are spoilt here."""
        return config.inner, dict(config.inner_params)

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()
        self._inner: Segmenter = create("segmenters", self._config.inner, self._config.inner_params)

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when there is none, or none is left."""
        mask = self._inner.segment(observation)
        rng = np.random.default_rng(zlib.crc32(np.packbits(mask).tobytes()))
        found = mask
        if self._config.edge_px > 0:
            found = _wavering(found, self._config.edge_px, self._config.length_px, rng)
        if self._config.tears > 0:
            found = _torn(found, self._config.tears, self._config.tear_px, rng)
        if self._config.coarse_px > 1:
            found = _coarse(found, self._config.coarse_px)
        if not found.any():
            raise GroundingError("of this mask the segmenter noisy leaves nothing; give it less noise")
        return _largest(found)


def _wavering(mask: Mask, edge: float, length: float, rng: np.random.Generator) -> Mask:
    """The mask within an outline moved by a smooth random field."""
    from scipy import ndimage

    inside, outside = (np.asarray(ndimage.distance_transform_edt(part)) for part in (mask, ~mask))
    depth = np.where(mask, inside - 0.5, 0.5 - outside)
    field = ndimage.gaussian_filter(rng.standard_normal(mask.shape), length / 2)
    return depth > field * (edge / field.std())


def _torn(mask: Mask, count: int, radius: float, rng: np.random.Generator) -> Mask:
    """The mask without disks around random points of its edge."""
    from scipy import ndimage

    edge = np.argwhere(mask & ~np.asarray(ndimage.binary_erosion(mask), bool))
    rows, columns = np.indices(mask.shape)
    found = mask.copy()
    for row, column in edge[rng.integers(len(edge), size=count)]:
        found &= np.hypot(rows - row, columns - column) > radius
    return found


def _coarse(mask: Mask, side: int) -> Mask:
    """The mask in squares of that side, each as most of its pixels are."""
    height, width = mask.shape
    padded = np.pad(mask, [(0, -height % side), (0, -width % side)])
    squares = padded.reshape(padded.shape[0] // side, side, padded.shape[1] // side, side).mean(axis=(1, 3)) >= 0.5
    return np.kron(squares, np.ones((side, side), bool))[:height, :width]


def _largest(mask: Mask) -> Mask:
    """The largest piece of a mask: noise leaves crumbs."""
    import cv2

    count, pieces = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    return mask if count < 3 else np.asarray(pieces) == 1 + np.argmax(np.bincount(pieces.ravel())[1:])
