"""What makes a kind of garment a kind: its corners, its layers, and where it is open."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Pattern:
    """How a kind of garment is put together; enough to sew one from an outline.

    Attributes:
        corners: keypoint names in the order of the template's vertices, clockwise as seen.
        top, bottom: the keypoints that are up and down when the garment lies upright.
        size: longest side of a typical garment's bounding box [m].
        layers: 1, or 2 for a front and a back.
        openings: pairs of neighbouring or farther corners, in order, between which front and back are not sewn.
        slits: corners at the inner end of a slit between their two neighbours, such as a crotch between the legs, that
            an outline does not show when its sides touch; it is cut open then.
        cyclic: see :class:`Garment`.
    """

    corners: tuple[str, ...]
    top: tuple[str, ...]
    bottom: tuple[str, ...]
    size: float
    layers: int = 1
    openings: tuple[tuple[str, str], ...] = ()
    slits: tuple[str, ...] = ()
    cyclic: tuple[str, ...] = ()

    def up(self, places: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """From the middle of the bottom to the middle of the top, shape (2,) or (3,); the garment's own up.

        Args:
            places: keypoint name -> position in any unit, shape (2,) or (3,).
        """
        top, bottom = (np.mean([places[name] for name in names], axis=0) for names in (self.top, self.bottom))
        return top - bottom
