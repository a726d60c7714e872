"""The grounding ``misfit``: another grounding whose polygon fits badly, so that what is robust to it can be told."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import FoldLine
from polyfold.plugins import create
from polyfold.plugins.interfaces import Grounding
from polyfold.polygon import Template
from polyfold.types import Observation, Scene


class Misfit:
    """Grounds as another does, then moves every vertex of the flat polygon a fixed way in a direction of its own.

    Implements :class:`polyfold.plugins.interfaces.Grounding`. The directions follow from the picture, anew in each: the
    next picture's fit begins from the polygon as it was moved. Only the model and its text are wrong, not the mask.
    """

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(extra="forbid", frozen=True)

        inner: str = Field(default="polygon", description="the grounding whose polygon is moved")
        inner_params: dict[str, Any] = Field(default_factory=dict, description="its parameters")
        vertex_px: float = Field(default=5.0, ge=0, le=100, description="how far every vertex is moved [px]")

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()
        self._inner: Grounding = create("groundings", self.config.inner, self.config.inner_params)

    def ground(
        self,
        observation: Observation,
        mask: NDArray[np.bool_],
        template: Template,
        previous: Scene | None = None,
        fold_line: FoldLine | None = None,
    ) -> Scene:
        """Ground one picture; see :class:`polyfold.plugins.interfaces.Grounding`.

        Raises:
            GroundingError: if the inner grounding does.
        """
        scene = self._inner.ground(observation, mask, template, previous, fold_line)
        if scene.model is None:
            return scene
        rng = np.random.default_rng(zlib.crc32(np.packbits(mask).tobytes()))
        angles = rng.uniform(0, 2 * np.pi, len(scene.model.rest))
        away = self.config.vertex_px * np.column_stack([np.cos(angles), np.sin(angles)])
        model = replace(scene.model, rest=scene.model.rest + away, _facets=None)
        text = model.to_text(scene.image_size, observation.camera.pixels_per_metre)
        return replace(scene, model=model, text=text)
