"""The segmenter ``background``: cloth is what was not there in a picture of the empty table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GroundingError
from polyfold.types import Observation
from polyfold_standard.segmenters.blobs import finished
from polyfold_standard.segmenters.choosing import best, candidates, reduced, smoothed
from polyfold_standard.segmenters.doubting import doubts_about
from polyfold_standard.segmenters.light import border_band, colours_of, unlike, unlike_picture

Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]

MOVES = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0))
"""The camera may have trembled by this much between the pictures [px of the working size]."""

ROUNDS = 4
"""Rounds in which the change of light is fitted."""

LEAST_NOISE = 3.0
"""Of two pictures of the same [RGB units]."""

NEW_AT_THE_BORDER = 5.0
"""What differs by more than this at the border reaches into the picture, such as an arm [deviations]."""


class BackgroundDifference:
    """Compares with a picture of the empty table from the same camera, noise and other light allowed for."""

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        picture: Path = Field(description="PNG or JPEG file: the empty table, from the same camera")
        smallest: float = Field(default=0.005, gt=0, lt=1, description="share of the picture that the cloth must cover")
        thin: float = Field(
            default=0.015, gt=0, le=0.2, description="what is thinner is no cloth, share of the picture's longer side"
        )

    argument: ClassVar[str] = "picture"

    @classmethod
    def files_read(cls, config: Config) -> Sequence[Path]:
        """The picture of the empty table."""
        return [config.picture]

    def __init__(self, config: Config) -> None:
        self._config = config
        self._empty = _read(config.picture)

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when there is none, or sizes differ."""
        rgb = observation.rgb
        small = reduced(rgb)
        before = smoothed(reduced(self._of_size(rgb.shape)))
        soft = smoothed(small)
        before = _in_the_light_of(soft, before)
        noise = _noise(soft, before)
        band = border_band(small.shape[:2])
        new = soft[band & (_moved(soft, before, 0.3, noise) > NEW_AT_THE_BORDER)]
        intruders = colours_of(new) if len(new) > 0.01 * band.sum() else []

        def unlike_table(light: float) -> Floats:
            distance = _moved(soft, before, light, noise)
            return np.minimum(distance, unlike(soft, intruders, light)) if intruders else distance

        thin = max(1, round(self._config.thin * max(small.shape[:2]) / 2))
        found = list(candidates(small, unlike_table, thin))
        return finished(rgb, best(found, self._config.smallest).mask)

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """What speaks against a mask, one line each."""
        return doubts_about(observation.rgb, mask)

    def _of_size(self, shape: tuple[int, ...]) -> Picture:
        """The empty table at a picture's size; cameras may give both in another resolution, but not another shape."""
        import cv2

        (height, width), (own_height, own_width) = shape[:2], self._empty.shape[:2]
        if abs(width * own_height - height * own_width) > max(width, own_width):
            raise GroundingError(
                f"the picture of the empty table {self._config.picture} measures {own_width} x {own_height} px, the "
                f"one with cloth {width} x {height}; take both with the same camera and do not crop one"
            )
        if (own_height, own_width) == (height, width):
            return self._empty
        return np.asarray(cv2.resize(self._empty, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def _read(path: Path) -> Picture:
    from PIL import Image, ImageOps, UnidentifiedImageError

    try:
        with Image.open(path) as picture:
            return np.asarray(ImageOps.exif_transpose(picture).convert("RGB"))
    except UnidentifiedImageError as error:
        raise GroundingError(
            f"the empty table {path} is no picture that can be read; give a PNG or JPEG file"
        ) from error
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        reason = getattr(error, "strerror", None) or error
        raise GroundingError(
            f"can't read the picture of the empty table {path} ({reason}); give a PNG or JPEG"
        ) from error


def _in_the_light_of(soft: Picture, before: Picture) -> Picture:
    """The empty table lit as it is now: as bright and warm as most of the border says, brighter to the same side."""
    band = border_band(soft.shape[:2])
    rows, columns = (places / max(soft.shape) for places in np.nonzero(band))
    ratio = np.log((soft[band] + 4.0) / (before[band] + 4.0))
    design = np.column_stack([np.ones(len(rows)), columns, rows])
    used = np.ones(len(rows), bool)
    plane = np.zeros((3, 3))
    for _ in range(ROUNDS):  # what reaches in at the border is left out
        plane = np.linalg.lstsq(design[used], ratio[used], rcond=None)[0]
        off = np.abs(ratio - design @ plane).max(axis=1)
        used = off <= 2.5 * np.median(off)
    down, right = np.indices(soft.shape[:2]) / max(soft.shape)
    gain = np.exp(np.stack([np.ones_like(down), right, down], axis=-1) @ plane)
    return np.clip(before * gain, 0, 255).astype(np.uint8)


def _noise(soft: Picture, before: Picture) -> float:
    """What most of the border differs by, where it differs least of a few pixels [RGB units]."""
    band = border_band(soft.shape[:2])
    off = _moved(soft, before, 0.3, 1.0)[band]
    return max(LEAST_NOISE, float(np.median(off)))


def _moved(soft: Picture, before: Picture, light: float, noise: float) -> Floats:
    """Distance from the nearest place of the empty table, the camera's trembling allowed for."""
    shifted = (np.roll(before, move, axis=(0, 1)) for move in MOVES)
    return np.minimum.reduce([unlike_picture(soft, place, light, noise) for place in shifted])
