"""Pictures of cloth on a table that is no flat colour."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.types import Observation

Floats = NDArray[np.float64]

ON_THE_TABLE = 1e-5
"""What is no higher than this is the table itself [m]."""


class Scenery(BaseModel):
    """What the picture's colours suffer from; as it is, nothing."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    table: Literal["as it is", "wood", "marble", "plain"] = Field(
        default="as it is", description="what the table's top is made of; plain has a grain of its own"
    )
    uneven: float = Field(default=0.0, ge=0, le=0.9, description="share by which light falls off across the picture")
    shadow: float = Field(default=0.0, ge=0, le=0.9, description="how dark soft shadows from outside are, as a share")
    grain: float = Field(default=0.0, ge=0, le=60, description="noise of the sensor, standard deviation [grey levels]")

    @property
    def plain(self) -> bool:
        """Whether it leaves pictures as they are."""
        return self == Scenery()


class PaintedCell:
    """One cell, with the table, light and shadows that stay with it.

    Args:
        scenery: what pictures suffer from.
        height, width: size of its pictures [px].
        seed: of all that is random.
    """

    def __init__(self, scenery: Scenery, height: int, width: int, seed: int) -> None:
        self._scenery = scenery
        self._rng = np.random.default_rng([seed, 7])
        self._table = self._top(height, width)
        self._light = self._fallen(height, width) * self._shadows(height, width)

    def paint(self, seen: Observation) -> Observation:
        """The same observation with its colours as the camera would measure them."""
        if self._scenery.plain:
            return seen
        picture = seen.rgb.astype(float)
        if self._table is not None:
            cloth = (seen.camera.elevation - seen.depth > ON_THE_TABLE)[..., None]
            picture = np.where(cloth, picture, self._table)
        picture = picture * self._light[..., None]
        if self._scenery.grain:
            picture += self._rng.normal(0.0, self._scenery.grain, picture.shape)
        return replace(seen, rgb=np.clip(np.rint(picture), 0, 255).astype(np.uint8))

    def _top(self, height: int, width: int) -> Floats | None:
        from polyfold_pybullet.scenery.tables import table

        name = self._scenery.table
        return None if name == "as it is" else table(name, height, width, self._rng)

    def _fallen(self, height: int, width: int) -> Floats:
        """Light of a lamp at one side: 1 at the brightest, shape (H, W)."""
        rows, columns = np.mgrid[-0.5 : 0.5 : height * 1j, -0.5 : 0.5 : width * 1j]
        side = self._rng.uniform(0, 2 * np.pi)
        along = np.cos(side) * columns + np.sin(side) * rows
        return 1.0 - self._scenery.uneven * (along - along.min()) / np.ptp(along)

    def _shadows(self, height: int, width: int) -> Floats:
        """Soft shadows of things beside the table: shares of light that are left, shape (H, W)."""
        from scipy import ndimage

        from polyfold_pybullet.scenery.tables import smooth_noise

        if not self._scenery.shadow:
            return np.ones((height, width))
        field = smooth_noise((height, width), self._rng.uniform(0.15, 0.25) * height, self._rng)
        dark = ndimage.gaussian_filter((field > 0.5).astype(float), self._rng.uniform(0.02, 0.05) * height)
        return np.asarray(1.0 - self._scenery.shadow * dark)
