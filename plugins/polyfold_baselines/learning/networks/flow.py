"""Points of the cloth and a sentence's tokens in one transformer: where each point goes.

H. Chen, J. Li, R. Wu, Y. Liu et al., MetaFold: Language-Guided Multi-Category Garment Folding Framework via Trajectory
Generation and Foundation Model, IROS 2025, arXiv:2503.08372.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning import sentences
from polyfold_baselines.learning.networks import nodes
from polyfold_baselines.learning.networks.network import Floats, Network

NODES = 256
MAP = SIDE // 2
SCALE = SIDE / 4
"""Ways are learned as shares of this [px of the view]."""
SPREAD = 0.25
"""What a pixel between two picks is worth, beside one that a pick is carried farther."""


class PointFlow(Network):
    """The cloth and a sentence to where points of the cloth go, and to the two that carry the others along.

    Args:
        width: of a token's features.
        depth: layers of the transformer.
        heads: of each attention.
    """

    def __init__(self, width: int = 192, depth: int = 4, heads: int = 4) -> None:
        super().__init__()
        self.arms = 2
        self.hear = nn.Linear(sentences.WIDTH, width)
        self.graph = nodes.Graph(width)
        layer = nn.TransformerEncoderLayer(
            width, heads, 4 * width, dropout=0.0, activation="gelu", batch_first=True, norm_first=True
        )
        self.together = nn.TransformerEncoder(layer, depth, nn.LayerNorm(width), enable_nested_tensor=False)
        self.out = nn.Linear(width, 3)

    def forward(self, now: Tensor, wanted: Tensor) -> Tensor:
        """Points, the ways that they go [px of the view], and logits of whether they go, shape (N, NODES, 5).

        Args:
            now: the cloth, shape (N, CHANNELS, SIDE, SIDE).
            wanted: tokens of the sentence, shape (N, T, WIDTH).
        """
        smaller = functional.avg_pool2d(now, 2)
        at = nodes.spread(smaller[:, 1] > 0.5, NODES)
        places = torch.stack([at % MAP, at // MAP], dim=-1).float()
        points = self.graph(places, smaller[:, 0].flatten(1).gather(1, at).float(), MAP)
        words = self.hear(wanted)
        there = torch.zeros(points.shape[:2], dtype=torch.bool, device=now.device)
        ended = torch.cat([sentences.ends(wanted), there], dim=1)
        tokens = self.together(torch.cat([words, points], dim=1), src_key_padding_mask=ended)
        found = self.out(tokens[:, -NODES:]).float()
        return torch.cat([2.0 * places + 0.5, SCALE * found[..., :2], found[..., 2:]], dim=-1)

    def loss(self, now: Tensor, wanted: Tensor, points: Tensor) -> Tensor:
        """How far ways are from those of a fold about the line that mirrors picks to places, and who goes at all."""
        at, ways, goes = self(now, wanted).split([2, 2, 1], dim=-1)
        true = mirrored(at, points)
        going = (true != 0).any(-1, keepdim=True).float()
        off = functional.smooth_l1_loss(ways / SCALE, true / SCALE, beta=0.1, reduction="none").sum(-1, keepdim=True)
        share = (off * going).sum((1, 2)) / going.sum((1, 2)).clamp_min(1.0)
        return share.mean() + functional.binary_cross_entropy_with_logits(goes, going)

    def read(self, logits: Tensor, masks: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Of the points that go, the two that are carried far and are far apart, and where they go.

        Returns:
            Picks and places [px of the view], shape (N, 2, 2) each.
        """
        found = logits.detach().cpu().double().numpy()
        pairs = np.stack([_carriers(*np.split(one, [2, 4], axis=-1)) for one in found])
        return pairs[..., :2], pairs[..., :2] + pairs[..., 2:]


def mirrored(at: Tensor, points: Tensor) -> Tensor:
    """The ways of points, shape (N, K, 2), in a fold by which picks come to lie on places, shape (N, 2, 2, 2).

    What lies on the picks' side of the line between is mirrored; the rest stays.
    """
    picks, places = points[:, :, 0], points[:, :, 1]
    across = functional.normalize((places - picks).mean(1), dim=-1)[:, None]
    from_line = ((at - (picks + places).mean(1)[:, None] / 2) * across).sum(-1, keepdim=True)
    return torch.where(from_line < 0, -2 * from_line * across, 0.0)


def _carriers(at: Floats, ways: Floats, goes: Floats) -> Floats:
    """The two points that carry, with their ways, shape (2, 4); the likeliest one twice where none goes."""
    going = np.flatnonzero(goes[:, 0] > 0)
    if not len(going):
        going = np.array([int(np.argmax(goes[:, 0]))])
    at, ways = at[going], ways[going]
    far = np.hypot(*ways.T)
    apart = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    worth = far[:, None] + far[None] + SPREAD * apart
    pair = list(np.unravel_index(int(np.argmax(worth)), worth.shape))
    return np.concatenate([at[pair], ways[pair]], axis=-1)
