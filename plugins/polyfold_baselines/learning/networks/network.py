"""What the one training asks of a network: heatmaps of picks and places, unless it says otherwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from torch import Tensor, nn

from polyfold_baselines.learning.networks import heatmaps

Floats = NDArray[np.float64]


class Network(nn.Module):
    """``network(now, wanted)`` gives logits; how they are learned and read stands here.

    Attributes:
        arms: 1 or 2.
    """

    arms: int

    def loss(self, now: Tensor, wanted: Tensor, points: Tensor) -> Tensor:
        """What is to be less.

        Args:
            now: the cloth, shape (N, CHANNELS, SIDE, SIDE).
            wanted: picture of the goal, or tokens of a sentence.
            points: what was demonstrated, shape (N, 2, 2, 2), see :func:`heatmaps.points_of`.
        """
        return heatmaps.loss(self(now, wanted), points, self.arms)

    def read(self, logits: Tensor, masks: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Picks, on the cloth, shape (N, SIDE, SIDE), and places [px of the view], shape (N, arms, 2) each."""
        return heatmaps.read(logits, masks, self.arms)
