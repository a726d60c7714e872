"""The segmenter ``grabcut``: OpenCV's GrabCut from a box, from strokes, or from what is found without them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GroundingError
from polyfold.types import Observation
from polyfold_standard.segmenters.blobs import filled, finished, main_blob, tidy
from polyfold_standard.segmenters.choosing import reduced
from polyfold_standard.segmenters.doubting import doubts_about
from polyfold_standard.segmenters.photo import PhotoSegmenter
from polyfold_standard.segmenters.prompts import Box, Stroke, in_pixels

Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]

AROUND = 0.03
"""Margin of the box around what was found, as a share of the picture."""

STROKE = 0.01
"""Width of a stroke as a share of the picture's longer side."""


class GrabCut:
    """Two mixtures of colours, of cloth and table, divided where the picture's edges are.

    Nothing outside the box is cloth. Without a box and strokes the box is drawn around what the segmenter ``photo``
    finds; where that finds nothing, or with strokes alone, it is the whole picture less a margin.
    """

    class Config(BaseModel):
        """Parameters; boxes and strokes are in shares of the picture, from 0 (left, top) to 1 (right, bottom)."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        box: Box | None = Field(default=None, description="[left, top, right, bottom] around the cloth")
        cloth: tuple[Stroke, ...] = Field(default=(), description="strokes on the cloth, each [[x, y], ...]")
        table: tuple[Stroke, ...] = Field(default=(), description="strokes on what is no cloth, each [[x, y], ...]")
        rounds: int = Field(default=5, ge=1, le=50, description="rounds of fitting and cutting")
        thin: float = Field(
            default=0.02, ge=0, le=0.2, description="what is thinner is no cloth, share of the picture's longer side"
        )

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when nothing is left in the box."""
        small = reduced(observation.rgb)
        labels = self._labels(observation, small.shape[:2])
        found = _divided(small, labels, self._config.rounds)
        thin = round(self._config.thin * max(small.shape[:2]) / 2)
        mask = tidy(found, thin) if thin else filled(main_blob(found))
        if not mask.any():
            raise GroundingError("GrabCut found no cloth; give a box that is nearer to it, or a stroke on it")
        return finished(observation.rgb, mask)

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """What speaks against a mask, one line each."""
        return doubts_about(observation.rgb, mask)

    def _labels(self, observation: Observation, shape: tuple[int, int]) -> Picture:
        """What is known of each pixel, in OpenCV's numbers, shape (h, w)."""
        import cv2

        config = self._config
        height, width = shape
        labels = np.full(shape, cv2.GC_BGD, np.uint8)
        left, top, right, bottom = config.box or self._default_box(observation)
        columns = slice(int(left * width), max(int(left * width) + 1, round(right * width)))
        rows = slice(int(top * height), max(int(top * height) + 1, round(bottom * height)))
        labels[rows, columns] = cv2.GC_PR_FGD
        thickness = max(1, round(STROKE * max(shape)))
        for strokes, label in ((config.cloth, cv2.GC_FGD), (config.table, cv2.GC_BGD)):
            for stroke in strokes:
                cv2.polylines(labels, [in_pixels(stroke, shape)[:, None]], False, int(label), thickness)
        if not (labels == cv2.GC_BGD).any():
            raise GroundingError(
                "the box leaves no table to compare with; leave a margin, or give a stroke on the table"
            )
        return labels

    def _default_box(self, observation: Observation) -> tuple[float, float, float, float]:
        whole = (AROUND, AROUND, 1 - AROUND, 1 - AROUND)
        if self._config.cloth or self._config.table:
            return whole
        try:
            found = PhotoSegmenter().segment(observation)
        except GroundingError:
            return whole
        rows, columns = (np.flatnonzero(found.any(axis=axis)) / found.shape[1 - axis] for axis in (1, 0))
        low_x, low_y = max(0.0, columns[0] - AROUND), max(0.0, rows[0] - AROUND)
        return low_x, low_y, min(1.0, columns[-1] + AROUND), min(1.0, rows[-1] + AROUND)


def _divided(small: Picture, labels: Picture, rounds: int) -> Mask:
    import cv2

    cv2.setRNGSeed(0)
    try:
        cv2.grabCut(small, labels, (0, 0, 1, 1), np.zeros((1, 65)), np.zeros((1, 65)), rounds, cv2.GC_INIT_WITH_MASK)
    except cv2.error as error:  # a box or strokes that leave one of the two without a pixel
        raise GroundingError("GrabCut needs both cloth and table; give a box with table around it") from error
    return np.asarray((labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD))
