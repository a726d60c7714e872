"""Demonstrations as tensors, and the garments that are held out to measure by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold_baselines.demos.demonstrating import PER_METRE, unpacked
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.learning.networks.heatmaps import points_of

TALL = 0.005
"""Heights are given to networks as shares of this [m]: a few plies."""
HELD_OUT = 0.15
"""Share of the garments that nothing is learned from."""


@dataclass(frozen=True, eq=False)
class Examples:
    """N folds.

    Attributes:
        frames: cloth before the fold, and goal, each as height and mask, float32, shape (N, 2, 2, SIDE, SIDE).
        points: picks and places, see :func:`polyfold_baselines.learning.networks.heatmaps.points_of`.
        sentences: which sentence asks for each fold, an index into ``texts``, shape (N,).
        texts: the sentences.
    """

    frames: Tensor
    points: NDArray[np.float32]
    sentences: NDArray[np.int64]
    texts: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.points)

    @property
    def masks(self) -> NDArray[np.bool_]:
        """The cloth before each fold, shape (N, SIDE, SIDE)."""
        return self.frames[:, 0, 1].numpy() > 0.5


def as_frame(heights: NDArray, masks: NDArray[np.bool_]) -> Tensor:
    """Height [m] and mask, shape (..., SIDE, SIDE), as networks see them, shape (..., 2, SIDE, SIDE)."""
    tall = np.where(masks, np.clip(heights / TALL, 0.0, 4.0), 0.0)
    return torch.from_numpy(np.stack([tall, masks], axis=-3).astype(np.float32))


def make_examples(demos: Demos, most_error_mm: float) -> tuple[Examples, Examples]:
    """Folds to learn from, and those of garments held out.

    Args:
        demos: what was demonstrated.
        most_error_mm: folds that ended farther from the ideal are not worth copying.

    Raises:
        ConfigError: if too few are left, or there is but one garment.
    """
    good = demos.columns["error_mm"] <= most_error_mm
    apart = held_out(demos)
    if good.sum() < 2:
        raise ConfigError(f"{good.sum()} good folds teach nothing; demonstrate more with 'polyfold demos'")
    return _examples(demos, np.flatnonzero(good & ~apart)), _examples(demos, np.flatnonzero(good & apart))


def held_out(demos: Demos) -> NDArray[np.bool_]:
    """Which folds nothing is learned from, by their garments, shape (N,). Raises ConfigError if there is but one."""
    seeds = np.unique(demos.columns["garment_seed"])
    if len(seeds) < 2:
        raise ConfigError(f"the folds of one garment, {seeds[0]}, teach nothing; collect more with 'polyfold demos'")
    held = seeds[-max(1, round(HELD_OUT * len(seeds))) :]
    return np.isin(demos.columns["garment_seed"], held)


def _examples(demos: Demos, rows: NDArray[np.int64]) -> Examples:
    columns = demos.columns
    seen = [
        as_frame(columns[height][rows] / PER_METRE, unpacked(columns[mask][rows]))
        for height, mask in (("height", "mask"), ("goal_height", "goal_mask"))
    ]
    texts, sentences = np.unique(columns["text"][rows], return_inverse=True)
    points = points_of(columns["picks"][rows], columns["places"][rows])
    return Examples(torch.stack(seen, dim=1), points, sentences, tuple(map(str, texts)))
