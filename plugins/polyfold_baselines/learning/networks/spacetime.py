"""The network of Foldsformer: patches of frames that attend within their frame and over time, then to the goal.

K. Mo et al., Foldsformer: Learning Sequential Multi-Step Cloth Manipulation With Space-Time Attention, IEEE RA-L 2023,
10.1109/LRA.2022.3229573. Attention is divided over time and space as in TimeSformer (arXiv:2102.05095).
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning.networks.network import Network

PATCH = 8
GRID = SIDE // PATCH
CHANNELS = 2


class SpaceTime(Network):
    """Two frames to heatmaps of picks and places.

    Args:
        arms: 1 or 2.
        width: of a patch's features.
        depth: blocks of divided attention.
        heads: of each attention.
    """

    def __init__(self, arms: int, width: int = 128, depth: int = 4, heads: int = 4) -> None:
        super().__init__()
        self.arms = arms
        self.stem = nn.Sequential(nn.Conv2d(CHANNELS, 16, 3, padding=1), nn.GELU(), nn.Conv2d(16, 32, 4, 4), nn.GELU())
        self.embed = nn.Conv2d(32, width, 2, 2)
        self.place = nn.Parameter(torch.zeros(1, 1, GRID * GRID, width))
        self.time = nn.Parameter(torch.zeros(1, 2, 1, width))
        nn.init.trunc_normal_(self.place, std=0.02)
        nn.init.trunc_normal_(self.time, std=0.02)
        self.blocks = nn.ModuleList(Block(width, heads) for _ in range(depth))
        self.across = nn.MultiheadAttention(width, heads, batch_first=True)
        self.norm_now, self.norm_goal, self.norm = (nn.LayerNorm(width) for _ in range(3))
        self.up = nn.Sequential(
            nn.ConvTranspose2d(width, 64, 2, 2), nn.GELU(), nn.Conv2d(64, 64, 3, padding=1), nn.GELU()
        )
        self.fuse = nn.Sequential(
            nn.Conv2d(64 + 2 * 32, 64, 3, padding=1), nn.GELU(),
            nn.Upsample(scale_factor=2, mode="bilinear", align_corners=False),
            nn.Conv2d(64, 32, 3, padding=1), nn.GELU(), nn.Conv2d(32, 2 * arms, 3, padding=1),
        )  # fmt: skip

    def forward(self, now: Tensor, wanted: Tensor) -> Tensor:
        """Heatmaps, shape (N, 2 arms, SIDE / 2, SIDE / 2).

        Args:
            now, wanted: the cloth and what it should be, shape (N, CHANNELS, SIDE, SIDE).
        """
        count, frames = len(now), torch.stack([now, wanted], dim=1)
        shallow = self.stem(frames.flatten(0, 1))
        tokens = self.embed(shallow).flatten(2).transpose(1, 2)
        tokens = tokens.reshape(count, 2, GRID * GRID, -1) + self.place + self.time
        for block in self.blocks:
            tokens = block(tokens)
        cloth, goal = self.norm_now(tokens[:, 0]), self.norm_goal(tokens[:, 1])
        both = self.norm(tokens[:, 0] + self.across(cloth, goal, goal, need_weights=False)[0])
        deep = self.up(both.transpose(1, 2).reshape(count, -1, GRID, GRID))
        return self.fuse(torch.cat([deep, shallow.reshape(count, -1, *shallow.shape[2:])], dim=1))


class Block(nn.Module):
    """Attention over time at each place, over space in each frame, and a layer that rises and falls."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.over_time = nn.MultiheadAttention(width, heads, batch_first=True)
        self.over_space = nn.MultiheadAttention(width, heads, batch_first=True)
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(3))
        self.rest = nn.Sequential(nn.Linear(width, 4 * width), nn.GELU(), nn.Linear(4 * width, width))

    def forward(self, tokens: Tensor) -> Tensor:
        """Tokens, shape (N, T, P, width)."""
        count, times, places, width = tokens.shape
        at = self.norms[0](tokens).transpose(1, 2).reshape(count * places, times, width)
        moved = self.over_time(at, at, at, need_weights=False)[0]
        tokens = tokens + moved.reshape(count, places, times, width).transpose(1, 2)
        at = self.norms[1](tokens).reshape(count * times, places, width)
        tokens = tokens + self.over_space(at, at, at, need_weights=False)[0].reshape(tokens.shape)
        return tokens + self.rest(self.norms[2](tokens))
