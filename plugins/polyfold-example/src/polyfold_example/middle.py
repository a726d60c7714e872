"""A simple policy: picks beside the point of the contour that is farthest from the fold line."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine
from polyfold.types import Action, Scene

__all__ = ["Middle"]


class Middle:
    """Carries the farthest point of the flap, with one arm or with two that are a little apart."""

    class Config(BaseModel):
        """Parameters, as the command line and TOML files set them."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        arms: int = Field(2, ge=1, le=2, description="number of arms")
        apart_px: float = Field(60.0, gt=0, description="distance between the two picks along the contour [px]")

    def __init__(self, config: Config) -> None:
        self._config = config

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Picks [px] on the contour left of the line, places mirrored."""
        distance = fold_line.distance(scene.contour)
        if distance.max() <= 0:
            raise PlanError("no cloth lies left of the fold line; turn the line round")
        farthest = scene.contour[distance.argmax()]
        flap = scene.contour[distance > 0]
        along = np.linalg.norm(flap - farthest, axis=1)
        picks = farthest[None] if self._config.arms == 1 else self._two(flap, along, farthest)
        return Action(picks, fold_line.mirror(picks))

    def _two(self, flap: np.ndarray, along: np.ndarray, farthest: np.ndarray) -> np.ndarray:
        first = flap[np.abs(along - self._config.apart_px / 2).argmin()]
        opposite = np.abs(along - self._config.apart_px / 2) + 1e3 * ((flap - farthest) @ (first - farthest) > 0)
        return np.stack([first, flap[opposite.argmin()]])
