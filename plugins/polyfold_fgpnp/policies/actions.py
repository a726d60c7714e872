"""The action that two picks end in, and the parameters that all policies share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.types import Action
from polyfold_fgpnp.policies.region import FoldRegion, along_line

Floats = NDArray[np.float64]


class PickConfig(BaseModel):
    """Parameters that all policies share."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    gamma: float = Field(
        default=0.04, ge=0, description="weight of the picks' distance to the fold line against the area"
    )
    one_arm_px: float = Field(
        default=20.0, ge=0, description="picks closer than this become one arm at their mean [px]"
    )
    inset_px: float = Field(default=2.5, ge=0, description="how far inside the cloth's edge to grasp [px]")


def to_action(region: FoldRegion, first: ArrayLike, second: ArrayLike, config: PickConfig) -> Action:
    """Turn two contour pixels [px], shape (2,), into an action: picks a little inside the cloth, places mirrored.

    Two picks closer than ``one_arm_px`` become one arm at their mean. Arms are ordered along the fold line. A place
    outside the image is pulled back on its way from the pick; two arms are pulled back by the same share, so the crease
    stays parallel to the fold line and the flap lands short of its goal instead of twisted.
    """
    line = region.fold_line
    picks = np.array([first, second], float)
    if np.hypot(*(picks[0] - picks[1])) < config.one_arm_px:
        picks = picks.mean(axis=0, keepdims=True)
    picks = np.array([_inside(pick, region.mask, config.inset_px) for pick in picks])
    picks = picks[np.argsort(along_line(line, picks), kind="stable")]
    height, width = region.mask.shape
    return Action(picks, _pull_back(picks, line.mirror(picks), width, height))


def _inside(pick: Floats, mask: NDArray[np.bool_], inset: float) -> Floats:
    """The nearest pixel ``inset`` deep in the cloth; where none is within twice that, the deepest one."""
    import cv2

    reach = int(np.ceil(2 * inset)) + 1
    x, y = np.round(pick).astype(int)
    top, left = max(0, y - 2 * reach), max(0, x - 2 * reach)
    window = mask[top : y + 2 * reach + 1, left : x + 2 * reach + 1]
    padded = np.pad(window, 1).astype(np.uint8)
    depth = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    rows, columns = np.nonzero(window)
    pixels = np.column_stack([columns + left, rows + top]).astype(float)
    away = np.hypot(*(pixels - pick).T)
    near = away <= max(2 * inset, 1.0)
    if not near.any():
        return _nearest_pixel(pick, mask)
    deep = np.minimum(depth[rows, columns][near], inset)
    order = np.lexsort([away[near], -deep.round(3)])
    return pixels[near][order[0]]


def _nearest_pixel(point: Floats, mask: NDArray[np.bool_]) -> Floats:
    y, x = np.nonzero(mask)
    nearest = np.argmin((x - point[0]) ** 2 + (y - point[1]) ** 2)
    return np.array([x[nearest], y[nearest]], float)


def _pull_back(picks: Floats, places: Floats, width: int, height: int) -> Floats:
    """Places moved back towards their picks, all by the same share, until they lie inside the image."""
    limit = np.array([width - 1.0, height - 1.0])
    way = places - picks
    with np.errstate(divide="ignore", invalid="ignore"):
        to_edge = np.where(way > 0, (limit - picks) / way, np.where(way < 0, -picks / way, np.inf))
    share = min(1.0, float(to_edge.min()))
    return np.clip(picks + share * way, 0.0, limit)
