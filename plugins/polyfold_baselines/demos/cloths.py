"""The cloth under the pictures of random drags: where every particle lay before and after, and lies at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold_baselines.demos.demonstrating import Arrays

Floats = NDArray[np.float64]

CLOTH = ("particles", "rest", "layer", "seam", "extent")
"""What a shard holds of the cloth itself, once for all of its folds."""


@dataclass(frozen=True, eq=False)
class Cloth:
    """The P particles of one garment, over the K drags that were made of it one after the other.

    Attributes:
        rows: which the drags are among all folds.
        particles: before the first drag and after each [m], shape (K + 1, P, 3): where they are seen on the table from
            the middle of the view, x right, y down, and how high they are.
        rest: of the flat pattern [m], shape (P, 2).
        layer: 0 for the panel that lay on the table, 1 for the one on top, shape (P,).
        seam: which belong to both panels, bool, shape (P,).
        extent: side of the view on the table [m].
    """

    rows: slice
    particles: Floats
    rest: Floats
    layer: NDArray[np.int8]
    seam: NDArray[np.bool_]
    extent: float

    @classmethod
    def of(cls, rows: slice, shard: Arrays) -> Cloth:
        """What a shard holds, in which heights and places are kept as float16: within a quarter of a millimetre."""
        particles, rest = shard["particles"].astype(float), shard["rest"].astype(float)
        return cls(rows, particles, rest, shard["layer"], shard["seam"], float(shard["extent"]))

    def apart_at_rest(self, one: NDArray[np.int64], other: NDArray[np.int64]) -> Floats:
        """How far particles are from others along the cloth [m], of any shape: over the seam between two panels."""
        apart = np.linalg.norm(self.rest[one] - self.rest[other], axis=-1)
        over = (self.layer[one] != self.layer[other]) & ~self.seam[one] & ~self.seam[other]
        if over.any():
            seam = self.rest[self.seam]
            there, back = (np.linalg.norm(self.rest[ends[over]][:, None] - seam, axis=-1) for ends in (one, other))
            apart[over] = (there + back).min(1)
        return apart
