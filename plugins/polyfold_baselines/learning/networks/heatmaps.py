"""Where to pick and place as heatmaps: targets, a loss that does not care which arm is which, and reading them off."""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from polyfold_baselines.demos.window import SIDE

SPREAD = 2.5
"""Standard deviation of a target [px of the view]."""
CLOSE = 6.0
"""Picks nearer than this are one arm's [px of the view]."""


def points_of(picks: NDArray[np.float32], places: NDArray[np.float32]) -> NDArray[np.float32]:
    """Points of N actions, shape (N, 2, 2, 2): arm, pick or place, x and y [px of the view].

    One arm's stand for both, as both arms would go there.
    """
    points = np.stack([picks, places], axis=2)
    alone = ~np.isfinite(points[:, 1]).all((1, 2))
    points[alone, 1] = points[alone, 0]
    return points


def targets(points: Tensor, side: int = SIDE) -> Tensor:
    """Heatmaps that sum to 1, shape (..., side, side), of points [px of the view], shape (..., 2)."""
    at = (points + 0.5) * (side / SIDE) - 0.5
    axis = torch.arange(side, dtype=points.dtype, device=points.device)
    spread = SPREAD * side / SIDE
    along_x = torch.exp(-((axis - at[..., 0:1]) ** 2) / (2 * spread**2))
    along_y = torch.exp(-((axis - at[..., 1:2]) ** 2) / (2 * spread**2))
    maps = along_y[..., :, None] * along_x[..., None, :]
    return maps / maps.sum((-2, -1), keepdim=True).clamp_min(1e-12)


def loss(logits: Tensor, points: Tensor, arms: int) -> Tensor:
    """Mean cross-entropy of heatmaps with their targets; with two arms of the better of both ways to name them.

    Args:
        logits: shape (N, 2 * arms, S, S): pick and place of each arm.
        points: shape (N, 2, 2, 2), see :func:`points_of`.
    """
    count, _, side, _ = logits.shape
    logs = functional.log_softmax(logits.reshape(count, arms, 2, side * side).float(), dim=-1)
    wanted = targets(points[:, :arms], side).reshape(count, arms, 2, side * side)
    straight = -(logs * wanted).sum(-1).sum((1, 2))
    if arms == 1:
        return straight.mean()
    crossed = -(logs * wanted.flip(1)).sum(-1).sum((1, 2))
    return torch.minimum(straight, crossed).mean()


def read(logits: Tensor, masks: NDArray[np.bool_], arms: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Picks, on the cloth, and places [px of the view], shape (N, arms, 2) each.

    Args:
        logits: shape (N, 2 * arms, S, S).
        masks: the cloth, shape (N, SIDE, SIDE).
    """
    maps = functional.interpolate(logits.float(), (SIDE, SIDE), mode="bilinear", align_corners=False)
    maps = maps.reshape(len(maps), arms, 2, SIDE, SIDE)
    cloth = torch.from_numpy(masks).to(maps.device)[:, None]
    picks = maps[:, :, 0].masked_fill(~cloth, -math.inf)
    return _peaks(picks), _peaks(maps[:, :, 1])


def merged(picks: NDArray[np.float64], places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One action's picks and places, shape (arms, 2): those of two arms that would pick in one place are one arm's."""
    if len(picks) == 2 and np.hypot(*(picks[0] - picks[1])) < CLOSE:
        return picks.mean(0, keepdims=True), places.mean(0, keepdims=True)
    return picks, places


def pick_error(picks: NDArray[np.float64], points: NDArray[np.float32]) -> NDArray[np.float64]:
    """How far N actions' picks are from those demonstrated [px of the view], shape (N,): mean over arms, named best."""
    true = points[:, : picks.shape[1], 0]
    straight = np.linalg.norm(picks - true, axis=2).mean(1)
    crossed = np.linalg.norm(picks - true[:, ::-1], axis=2).mean(1)
    return np.minimum(straight, crossed)


def _peaks(maps: Tensor) -> NDArray[np.float64]:
    """The highest points of maps, shape (N, arms, S, S), as x and y, shape (N, arms, 2)."""
    flat = maps.flatten(2).argmax(-1)
    side = maps.shape[-1]
    return torch.stack([flat % side, flat // side], dim=-1).cpu().numpy().astype(float)
