"""The segmenter ``photo``: one garment on a plain, textured or shadowed table, without being told where."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.types import Observation
from polyfold_standard.segmenters.blobs import finished
from polyfold_standard.segmenters.choosing import best, candidates, reduced, smoothed
from polyfold_standard.segmenters.doubting import doubts_about, with_inlays
from polyfold_standard.segmenters.light import border_band, colours_of, unlike

Mask = NDArray[np.bool_]


class PhotoSegmenter:
    """Cloth is what no light makes of the colours at the picture's border.

    The table's colours are read off the border, with whatever reaches in there. Pixels are compared with them in every
    light, so that shadows and sun spots stay table; of the masks in more and less varied light the one whose outline is
    best to be seen is taken, and GrabCut moves it to where the cloth ends. What is thin, such as a cable, is cut off.
    """

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        smallest: float = Field(default=0.01, gt=0, lt=1, description="share of the picture that the cloth must cover")
        thin: float = Field(
            default=0.02, gt=0, le=0.2, description="what is thinner is no cloth, share of the picture's longer side"
        )

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when there is none, or more than one thing."""
        small = reduced(observation.rgb)
        soft = smoothed(small)
        table = colours_of(soft[border_band(small.shape[:2])])
        thin = max(1, round(self._config.thin * max(small.shape[:2]) / 2))
        found = list(candidates(small, lambda light: unlike(soft, table, light), thin))
        mask = with_inlays(small, best(found, self._config.smallest), found)
        return finished(observation.rgb, mask)

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """What speaks against a mask, one line each."""
        return doubts_about(observation.rgb, mask)
