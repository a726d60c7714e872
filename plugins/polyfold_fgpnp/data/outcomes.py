"""How well a fold came out: by silhouette, as a real camera can tell, and by particles, which only a simulator can."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import chamfer, contour_of, iou
from polyfold.types import SimState
from polyfold_fgpnp.policies.region import FoldRegion

Floats = NDArray[np.float64]

ALPHA, BETA = 1.0, 1.0
"""Weights of the contour reward; the paper has 1500 and 1 for a distance whose unit it does not give."""

LEAST_IDLE_PX = 4.0
"""Doing nothing counts as at least this far from the goal, lest a sliver's reward be all noise."""


@dataclass(frozen=True)
class Outcome:
    """What one fold did.

    Attributes:
        chamfer_px: symmetric Chamfer distance between the resulting and the expected contour [px].
        iou: of the resulting and the expected silhouette.
        flap_mm: mean distance of the flap's particles from their mirrored positions [mm].
        rest_mm: mean displacement of all other particles [mm]; 0 if there are none.
    """

    chamfer_px: float
    iou: float
    flap_mm: float
    rest_mm: float

    @property
    def error_mm(self) -> float:
        """How far the fold is from the ideal one: the flap's error and what the rest was dragged [mm]."""
        return self.flap_mm + self.rest_mm


@dataclass(frozen=True, eq=False)
class Expectation:
    """The ideal result of folding a region: its mask and its particles mirrored, the rest as it was.

    Attributes:
        mask: expected silhouette, bool, shape (H, W).
        idle_chamfer_px: Chamfer distance of the untouched cloth's contour from the expected one [px].
        travel_mm: mean way that the flap's particles have to go [mm]: the error of doing nothing.
    """

    mask: NDArray[np.bool_]
    idle_chamfer_px: float
    travel_mm: float
    _contour: Floats
    _before: Floats
    _target: Floats
    _flap: NDArray[np.bool_]

    def judge(self, mask: NDArray[np.bool_], state: SimState) -> Outcome:
        """Compare a result's silhouette, bool, shape (H, W), and particles with this."""
        after = state.positions[:, :2]
        error = np.hypot(*(after - self._target).T)
        moved = np.hypot(*(after - self._before).T)[~self._flap]
        distance = chamfer(contour_of(mask), self._contour) if mask.any() else float(np.hypot(*mask.shape))
        return Outcome(
            distance,
            iou(mask, self.mask),
            1000 * float(error[self._flap].mean()) if self._flap.any() else float("nan"),
            1000 * float(moved.mean()) if len(moved) else 0.0,
        )


def expect(region: FoldRegion, mask: NDArray[np.bool_], state: SimState) -> Expectation:
    """What folding a region ideally gives.

    Args:
        region: what the fold line lifts.
        mask: the cloth, bool, shape (H, W).
        state: its particles; the flap's are those seen inside the partial mask.
    """
    pixels = state.camera.to_pixels(state.positions[:, :2])
    x, y = np.clip(np.round(pixels).astype(int), 0, np.array(mask.shape)[::-1] - 1).T
    flap = region.fold_line.lifts(pixels) & region.mask[y, x]
    before = state.positions[:, :2]
    target = np.where(flap[:, None], state.camera.to_world(region.fold_line.mirror(pixels))[:, :2], before)
    expected = (mask & ~region.mask) | mirrored_mask(region)
    contour = contour_of(expected)
    way = np.hypot(*(target - before)[flap].T)
    return Expectation(
        expected,
        chamfer(contour_of(mask), contour),
        1000 * float(way.mean()) if len(way) else float("nan"),
        contour,
        before,
        target,
        flap,
    )


def mirrored_mask(region: FoldRegion) -> NDArray[np.bool_]:
    """A region's mask reflected across its line, bool, shape (H, W)."""
    import cv2

    origin, right, below = region.fold_line.mirror([(0, 0), (1, 0), (0, 1)])
    matrix = np.column_stack([right - origin, below - origin, origin])
    height, width = region.mask.shape
    return cv2.warpAffine(255 * region.mask.astype(np.uint8), matrix, (width, height)) > 127


def contour_reward(chamfer_px: ArrayLike, idle_chamfer_px: ArrayLike) -> Floats:
    """R = beta - alpha D with D in units of what doing nothing costs: 1 is ideal, 0 as good as nothing (Sec. IV-D).

    So it does not depend on the camera, the garment's size or the flap's. It can be negative.

    Args:
        chamfer_px: distances of contours from the expected ones [px], shape (...).
        idle_chamfer_px: of the contours before the folds [px], shape (...).
    """
    return BETA - ALPHA * np.asarray(chamfer_px, float) / np.maximum(np.asarray(idle_chamfer_px, float), LEAST_IDLE_PX)


def particle_reward(error_mm: ArrayLike, travel_mm: ArrayLike) -> Floats:
    """1 - error of flap and rest / travel: 1 is ideal, 0 as good as nothing. Privileged: it needs the particles.

    By the flap alone, picks near the crease look best on small thick flaps: they lay it down well and drag the rest.

    Args:
        error_mm: errors of flap and rest [mm], shape (...).
        travel_mm: how far the flaps have to go [mm], shape (...).
    """
    return 1.0 - np.asarray(error_mm, float) / np.asarray(travel_mm, float)
