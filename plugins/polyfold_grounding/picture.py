"""Groundings that show the picture: on its own, or beside what another grounding says in words."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GroundingError
from polyfold.geometry import FoldLine, contour_of
from polyfold.plugins.interfaces import Grounding
from polyfold.polygon import Template
from polyfold.types import Observation, Scene
from polyfold_grounding.keypoints import KeypointsGrounding
from polyfold_grounding.polygon import PolygonGrounding

__all__ = ["ImageGrounding", "KeypointsImageGrounding", "PolygonImageGrounding"]


class ImageGrounding:
    """The picture alone: nothing is fitted, and the text holds no more than the garment's kind and the image's size.

    The language model has to see the cloth (paper, Table IV, *Image*).
    """

    def ground(
        self,
        observation: Observation,
        mask: NDArray[np.bool_],
        template: Template,
        previous: Scene | None = None,
        fold_line: FoldLine | None = None,
    ) -> Scene:
        """Ground one picture; see :class:`polyfold.plugins.interfaces.Grounding`."""
        if not mask.any():
            raise GroundingError("no cloth is visible; lay the garment where the camera sees it")
        height, width = mask.shape
        text = json.dumps({"garment": template.kind, "image": {"width": width, "height": height}})
        contour = contour_of(mask)
        return Scene(
            template.kind, (width, height), mask, contour, None, text, picture=observation.rgb, shown=("image",)
        )


class _WithPicture:
    """What another grounding says, and the picture beside it."""

    def __init__(self, words: Grounding) -> None:
        self._words = words

    def ground(
        self,
        observation: Observation,
        mask: NDArray[np.bool_],
        template: Template,
        previous: Scene | None = None,
        fold_line: FoldLine | None = None,
    ) -> Scene:
        """Ground one picture; see :class:`polyfold.plugins.interfaces.Grounding`."""
        scene = self._words.ground(observation, mask, template, previous, fold_line)
        return replace(scene, picture=observation.rgb, shown=(*scene.shown, "image"))


class KeypointsImageGrounding(_WithPicture):
    """The grounding ``keypoints`` and the picture (paper, Table IV, *Keypoints + Image*)."""

    class Config(KeypointsGrounding.Config):
        """Parameters of ``keypoints``."""

    def __init__(self, config: Config | None = None) -> None:
        super().__init__(KeypointsGrounding(config))


class PolygonImageGrounding(_WithPicture):
    """The grounding ``polygon`` and the picture (paper, Table IV, *Polygon Model + Image*)."""

    class Config(PolygonGrounding.Config):
        """Parameters of ``polygon``."""

    def __init__(self, config: Config | None = None) -> None:
        super().__init__(PolygonGrounding(config))
