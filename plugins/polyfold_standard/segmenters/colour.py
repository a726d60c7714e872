"""The segmenter ``colour``: cloth is what differs in colour from the table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GarmentError, GroundingError
from polyfold.garments import find_cloth
from polyfold.types import Observation


class ColourThreshold:
    """Thresholds the colour distance from the table, whose colour is read off the image's border."""

    class Config(BaseModel):
        """Parameters of the colour segmenter."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        threshold: float = Field(default=25.0, gt=0, le=441, description="colour distance from the table, RGB units")
        smallest: float = Field(default=0.002, ge=0, lt=1, description="share of the image that the cloth must cover")

    def __init__(self, config: Config) -> None:
        self._config = config

    def segment(self, observation: Observation) -> NDArray[np.bool_]:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when there is none."""
        try:
            return find_cloth(observation.rgb, self._config.threshold, self._config.smallest)
        except GarmentError as error:
            raise GroundingError(f"segmentation failed: {error}") from error
