"""The grounding ``polygon``: the parameterized polygon model, fitted once and followed from fold to fold."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.geometry import FoldLine
from polyfold.polygon import Template
from polyfold.types import Observation, Scene
from polyfold_grounding.fitting.evidence import Evidence

__all__ = ["PolygonGrounding"]

UNTOLD = 0.001
"""What one layer of the model is taken to be high where the template does not say [m]."""


class PolygonGrounding:
    """Fits the garment's template to the silhouette, then follows it.

    Implements :class:`polyfold.plugins.interfaces.Grounding`.

    The first picture is fitted from all rotations; corners of squares and rectangles are named there, by the edge
    nearest the image's top, and keep their names. After a fold the previous model is folded along the line and
    refitted; if that explains the picture badly, the garment was displaced and is searched at all rotations.
    """

    class Config(BaseModel):
        """Parameters of the fit."""

        model_config = ConfigDict(extra="forbid", frozen=True)

        optimizer: Literal["lm", "pattern"] = Field(
            default="lm", description="Levenberg-Marquardt, or Miller's pattern search as in the paper (much slower)"
        )
        rotations: int = Field(default=24, ge=4, le=360, description="headings tried in the first picture")
        displaced_px: float = Field(
            default=1.5,
            gt=0.0,
            description="Chamfer distance [px, for a garment of 150 x 150 px] above which all rotations are searched",
        )
        ply_thickness: float | None = Field(
            default=None,
            ge=0.0,
            le=0.02,
            description="thickness of one layer of the model in a packet [m]; by default the fabric's, all panels",
        )

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

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
            GroundingError: if too little cloth is visible.
        """
        from polyfold_grounding.fitting.tracking import first_model, next_model  # imports numba

        evidence = Evidence.of(mask)
        if previous is None or previous.model is None:
            tracked = first_model(template, evidence, self.config.rotations, self.config.optimizer)
        else:
            thickness = self._thickness(template) * observation.camera.pixels_per_metre
            tracked = next_model(
                previous.model, previous.contour, fold_line, evidence, self.config.displaced_px, thickness
            )
        size = (mask.shape[1], mask.shape[0])
        text = tracked.model.to_text(size, observation.camera.pixels_per_metre)
        return Scene(template.kind, size, mask, evidence.contour, tracked.model, text, tracked.chamfer, tracked.notes)

    def _thickness(self, template: Template) -> float:
        """Of one layer of the model [m]: as chosen, else as said of the fabric."""
        said = UNTOLD if template.thickness is None else template.thickness
        return said if self.config.ply_thickness is None else self.config.ply_thickness
