"""The segmenter ``sam``: a promptable network of your own, as an ONNX file that OpenCV runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, field_validator

from polyfold.errors import GroundingError
from polyfold.types import Observation
from polyfold_standard.segmenters.blobs import filled, main_blob
from polyfold_standard.segmenters.doubting import doubts_about
from polyfold_standard.segmenters.prompts import Box, Point, in_pixels

Mask = NDArray[np.bool_]
Floats = NDArray[np.float32]

SIDE, POINTS = 1024, 6
"""Side of the square picture that the network is shown [px], and how many points it takes."""

CLOTH, TOP_LEFT, BOTTOM_RIGHT, NONE = 1.0, 2.0, 3.0, -1.0
"""Labels of points, as the SAM family has them."""

INPUTS = ("batched_images", "batched_point_coords", "batched_point_labels")
OUTPUTS = ("output_masks", "iou_predictions")

INTERFACE = (
    f"{INPUTS[0]} (1, 3, {SIDE}, {SIDE}), {INPUTS[1]} (1, 1, {POINTS}, 2), {INPUTS[2]} (1, 1, {POINTS}, 1) -> "
    f"{OUTPUTS[0]} (1, 1, M, {SIDE}, {SIDE}), {OUTPUTS[1]} (1, 1, M)"
)

MIDDLE = ((0.5, 0.5),)


class PromptableSegmenter:
    """Asks a network of the SAM family for the thing at points or in a box.

    The weights are one ONNX file with the interface of EfficientSAM in OpenCV's model zoo: a picture of 1024 x 1024 px
    from 0 to 1, up to 6 points [px] and their labels (1 cloth, 2 and 3 the corners of a box, -1 nothing) give masks
    and how good each is. ONNX describes arithmetic and carries no code.
    """

    class Config(BaseModel):
        """Parameters; box and points are in shares of the picture, from 0 (left, top) to 1 (right, bottom)."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        weights: Path = Field(description="ONNX file with the interface of EfficientSAM in OpenCV's model zoo")
        box: Box | None = Field(default=None, description="[left, top, right, bottom] around the cloth")
        points: tuple[Point, ...] = Field(default=(), description="points on the cloth; by default the middle")
        no_cloth: tuple[Point, ...] = Field(default=(), description="points that the mask must leave out")

        @field_validator("points")
        @classmethod
        def _few(cls, points: tuple[Point, ...]) -> tuple[Point, ...]:
            if len(points) > POINTS - 2:
                raise ValueError(f"at most {POINTS - 2} points can be shown")
            return points

    argument: ClassVar[str] = "weights"

    @classmethod
    def files_read(cls, config: Config) -> Sequence[Path]:
        """The network."""
        return [config.weights]

    def __init__(self, config: Config) -> None:
        self._config = config
        self._network = _load(config.weights)

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when the network finds none, or fails."""
        import cv2

        height, width = observation.rgb.shape[:2]
        masks, scores = self._answer(observation.rgb)
        mask = masks[self._best(masks, scores)]
        found = filled(main_blob(np.asarray(cv2.resize(mask, (width, height), interpolation=cv2.INTER_LINEAR) >= 0.0)))
        if not found.any():
            raise GroundingError("the network finds no cloth there; give a box around it or points on it")
        return found

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """What speaks against a mask, one line each."""
        return doubts_about(observation.rgb, mask)

    def _answer(self, rgb: NDArray[np.uint8]) -> tuple[Floats, Floats]:
        """Logits, shape (M, 1024, 1024), and how good each is, shape (M,)."""
        import cv2

        small = cv2.resize(rgb, (SIDE, SIDE), interpolation=cv2.INTER_LINEAR)
        image = (np.asarray(small, np.float32) / 255.0).transpose(2, 0, 1)[None]
        try:
            for name, value in zip(INPUTS, (np.ascontiguousarray(image), *self._prompt()), strict=True):
                self._network.setInput(value, name)
            masks, scores = (np.asarray(found, np.float32) for found in self._network.forward(list(OUTPUTS)))
        except cv2.error as error:
            raise GroundingError(
                f"the network {self._config.weights} can't be asked ({error.err}); its interface must be {INTERFACE}"
            ) from error
        if masks.shape[-2:] != (SIDE, SIDE) or masks.size != scores.size * SIDE * SIDE or not np.isfinite(masks).all():
            raise GroundingError(
                f"the network {self._config.weights} answers with masks of shape {masks.shape} and scores of "
                f"{scores.shape}, or with no numbers; its interface must be {INTERFACE}"
            )
        return masks.reshape(-1, SIDE, SIDE), scores.ravel()

    def _prompt(self) -> tuple[Floats, Floats]:
        """Points [px of the square], shape (1, 1, 6, 2), and their labels, shape (1, 1, 6, 1)."""
        config = self._config
        points = list(config.points if config.points or config.box else MIDDLE)
        labels = [CLOTH] * len(points)
        if config.box is not None:
            left, top, right, bottom = config.box
            points, labels = [(left, top), (right, bottom), *points], [TOP_LEFT, BOTTOM_RIGHT, *labels]
        places, kinds = np.zeros((1, 1, POINTS, 2), np.float32), np.full((1, 1, POINTS, 1), NONE, np.float32)
        places[0, 0, : len(points)] = in_pixels(tuple(points), (SIDE, SIDE))
        kinds[0, 0, : len(points), 0] = labels
        return places, kinds

    def _best(self, masks: Floats, scores: Floats) -> int:
        """The best of the masks that leave out what is no cloth; the best of all if none does."""
        order = [int(index) for index in np.argsort(-scores)]
        if not self._config.no_cloth:
            return order[0]
        x, y = in_pixels(self._config.no_cloth, (SIDE, SIDE)).T
        return next((index for index in order if not (masks[index][y, x] >= 0.0).any()), order[0])


def _load(path: Path) -> Any:
    import cv2

    if not path.is_file():
        raise GroundingError(f"there is no file {path}; give the ONNX file of a promptable network")
    try:
        network = cv2.dnn.readNetFromONNX(str(path))
    except cv2.error as error:
        raise GroundingError(
            f"{path} is no ONNX file that OpenCV can read; give EfficientSAM of OpenCV's model zoo, or one like it"
        ) from error
    missing = set(OUTPUTS) - set(network.getUnconnectedOutLayersNames())
    if missing:
        raise GroundingError(f"the network {path} has no {' and no '.join(sorted(missing))}; it must be {INTERFACE}")
    return network
