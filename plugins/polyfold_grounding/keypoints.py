"""The grounding ``keypoints``: named points of a flat garment, nameless corners of the contour once it is folded."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.polygon import Template
from polyfold.types import Observation, Scene
from polyfold_grounding.fitting.evidence import Evidence
from polyfold_grounding.polygon import PolygonGrounding

__all__ = ["KeypointsGrounding"]


class KeypointsGrounding:
    """Points without structure (paper, Table IV, *Keypoints*).

    The paper detects the keypoints of flat garments with a network (ClothFunnels) and takes points of the contour once
    the garment is folded, since no detector knows folded ones. Here the keypoints of the flat garment come from the
    polygon fit. Edges, layers and creases are withheld, and so is the model from everything downstream; where the
    keypoints lay before the first fold stays known.
    """

    class Config(PolygonGrounding.Config):
        """Parameters of the fit to the flat garment, and of the contour's points."""

        tolerance_px: float = Field(
            default=3.0,
            gt=0.0,
            description="how far the contour may stray from the polygon of its corners [px at 150 x 150 px of cloth]",
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

        A garment is flat until a fold is made.

        Raises:
            GroundingError: if too little cloth is visible.
        """
        evidence = Evidence.of(mask)
        points, residual = self._contour_corners(evidence), float("nan")
        notes: tuple[str, ...] = ()
        if previous is None or (fold_line is None and _named(previous)):
            points, residual, notes = self._flat_keypoints(template, evidence)
        size = (mask.shape[1], mask.shape[0])
        image = {"width": size[0], "height": size[1], "px_per_cm": round(observation.camera.pixels_per_metre / 100, 2)}
        content = {"garment": template.kind, "image": image, "keypoints": points}
        if previous is not None and not isinstance(points, dict):
            content["flat"] = _flat(previous)
        text = json.dumps(content)
        return Scene(template.kind, size, mask, evidence.contour, None, text, residual, notes, shown=("keypoints",))

    def _flat_keypoints(
        self, template: Template, evidence: Evidence
    ) -> tuple[Mapping[str, Sequence[int]], float, tuple[str, ...]]:
        """Named points [px], the fit's Chamfer distance [px] and its notes."""
        from polyfold_grounding.fitting.tracking import first_model  # imports numba

        fitted = first_model(template, evidence, self.config.rotations, self.config.optimizer)
        vertices = dict(zip(fitted.model.names, fitted.model.rest, strict=True))
        return {name: _whole(point) for name, point in vertices.items()}, fitted.chamfer, fitted.notes

    def _contour_corners(self, evidence: Evidence) -> list[Sequence[int]]:
        """Corners of the simplified contour [px], in its order."""
        import cv2

        contour = evidence.contour.astype(np.float32)
        corners = cv2.approxPolyDP(contour, self.config.tolerance_px * evidence.scale, True)[:, 0, :]
        return [_whole(corner) for corner in corners]


def _named(scene: Scene) -> bool:
    """Whether the points of a scene of this grounding have names."""
    return isinstance(json.loads(scene.text).get("keypoints"), dict)


def _flat(scene: Scene) -> Mapping[str, Sequence[int]]:
    """Where the keypoints lay before the first fold."""
    content = json.loads(scene.text)
    return content.get("flat", content["keypoints"])


def _whole(point: Sequence[float]) -> list[int]:
    return [round(float(value)) for value in point]
