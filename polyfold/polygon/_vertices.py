"""The state of one named vertex of a folded garment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class VertexState:
    """One named vertex as it lies now.

    Attributes:
        point: position [px], shape (2,).
        description: what it is, in words; says so when it is folded over.
        layers: layers it belongs to, lowest first; a crease's end belongs to two or more.
        visible: nothing lies on top of it.
        reversed: the reverse side is up.
    """

    point: NDArray[np.float64]
    description: str
    layers: tuple[int, ...]
    visible: bool
    reversed: bool
