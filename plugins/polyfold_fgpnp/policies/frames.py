"""How a network sees a flap: in a canonical frame, or as the camera does.

In the canonical frame the fold line is the left border and the flap fills the image, so that a network's map turns,
moves and scales with the cloth by construction. The camera frame is the paper's: the partial mask at full size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold_fgpnp.policies.region import FoldRegion

Floats = NDArray[np.float64]
FrameName = Literal["canonical", "camera"]

CANONICAL_SIDE = 128
"""Height and width of the canonical frame [px]."""

MARGIN = 2.0
"""Room around the flap in the canonical frame [px]."""

FRAMES: tuple[FrameName, ...] = ("canonical", "camera")


@dataclass(frozen=True, eq=False)
class Frame:
    """Maps pixels of the camera to those of a network's map.

    Attributes:
        matrix: affine map, shape (2, 3).
    """

    matrix: Floats

    def apply(self, points: ArrayLike) -> Floats:
        """Pixels of the camera [px], shape (..., 2), as pixels of the map [px], shape (..., 2)."""
        return np.asarray(points, float) @ self.matrix[:, :2].T + self.matrix[:, 2]


@dataclass(frozen=True, eq=False)
class View:
    """What a network is given.

    Attributes:
        image: channels in 0..255, uint8, shape (C, H, W). Canonical: the flap, and what it will lie on, mirrored
            beneath it. Camera: the partial mask.
        line: start and end of the fold line over the image's size, shape (4,); constant in the canonical frame.
        frame: where the camera's pixels are in the map.
    """

    image: NDArray[np.uint8]
    line: NDArray[np.float32]
    frame: Frame


def view(region: FoldRegion, mask: NDArray[np.bool_], frame: FrameName) -> View:
    """The flap of a cloth, bool, shape (H, W), as a network of that frame sees it."""
    if frame == "camera":
        return _camera_view(region)
    return _canonical_view(region, mask)


def _camera_view(region: FoldRegion) -> View:
    height, width = region.mask.shape
    line = np.array([*region.fold_line.start, *region.fold_line.end], np.float32)
    return View(
        255 * region.mask[None].astype(np.uint8),
        line / np.array([width, height, width, height], np.float32),
        Frame(np.eye(2, 3)),
    )


def _canonical_view(region: FoldRegion, mask: NDArray[np.bool_]) -> View:
    line = region.fold_line
    start, end = np.asarray(line.start), np.asarray(line.end)
    along = (end - start) / line.length
    away = np.array([along[1], -along[0]])
    reach = (region.points - start) @ along
    low, high = min(0.0, float(reach.min())), max(line.length, float(reach.max()))
    room = CANONICAL_SIDE - 1 - 2 * MARGIN
    scale = room / max(high - low, float(region.distances.max()))
    top = (CANONICAL_SIDE - 1 - scale * (high + low)) / 2
    lifted = _affine(scale * away, scale * along, start, MARGIN, top)
    landed = _affine(-scale * away, scale * along, start, MARGIN, top)
    flap, rest = _warped(region.mask, lifted), _warped(mask & ~region.mask, landed)
    return View(np.stack([flap, rest]), np.zeros(4, np.float32), Frame(lifted))


def _affine(across: Floats, along: Floats, origin: Floats, left: float, top: float) -> Floats:
    """The map that sends ``origin`` to (left, top) and has these rows."""
    rows = np.stack([across, along])
    return np.column_stack([rows, np.array([left, top]) - rows @ origin])


def _warped(mask: NDArray[np.bool_], matrix: Floats) -> NDArray[np.uint8]:
    import cv2

    side = CANONICAL_SIDE
    return np.asarray(
        cv2.warpAffine(255 * mask.astype(np.uint8), matrix, (side, side), flags=cv2.INTER_LINEAR), np.uint8
    )
