"""A U-Net whose features a sentence scales and shifts, and its heatmaps.

Modulation as in E. Perez et al., FiLM: Visual Reasoning with a General Conditioning Layer, AAAI 2018,
10.1609/aaai.v32i1.11671.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from polyfold_baselines.learning.networks.network import Network
from polyfold_baselines.learning.sentences import WIDTH, pooled

CHANNELS = 2


class ConditionedUNet(Network):
    """The cloth and a sentence to heatmaps of picks and places.

    Args:
        arms: 1 or 2.
        width: of the deepest features; each level above has half of them, at least 16.
        depth: levels below the first.
    """

    def __init__(self, arms: int, width: int = 128, depth: int = 4) -> None:
        super().__init__()
        self.arms = arms
        widths = [max(16, width >> (depth - level)) for level in range(depth + 1)]
        self.down = nn.ModuleList(_Level(a, b) for a, b in zip([CHANNELS, *widths[:-1]], widths, strict=True))
        self.up = nn.ModuleList(_Level(a + b, b) for a, b in zip(widths[:1:-1], widths[-2:0:-1], strict=True))
        self.sentence = nn.Sequential(nn.Linear(WIDTH, width), nn.GELU())
        self.modulations = nn.ModuleList(nn.Linear(width, 2 * features) for features in (*widths, *widths[-2:0:-1]))
        self.out = nn.Conv2d(widths[1], 2 * arms, 1)

    def forward(self, now: Tensor, wanted: Tensor) -> Tensor:
        """Heatmaps, shape (N, 2 arms, SIDE / 2, SIDE / 2).

        Args:
            now: the cloth, shape (N, CHANNELS, SIDE, SIDE).
            wanted: tokens of the sentence, shape (N, T, WIDTH).
        """
        told = self.sentence(pooled(wanted))
        modulations = iter(self.modulations)
        features, kept = now, list[Tensor]()
        for number, level in enumerate(self.down):
            features = nn.functional.max_pool2d(features, 2) if number else features
            features = level(features, next(modulations)(told))
            kept.append(features)
        for level, beside in zip(self.up, kept[-2:0:-1], strict=True):
            larger = nn.functional.interpolate(features, scale_factor=2.0, mode="bilinear", align_corners=False)
            features = level(torch.cat([larger, beside], dim=1), next(modulations)(told))
        return self.out(features)


class _Level(nn.Module):
    """Two convolutions, the second's features scaled and shifted."""

    def __init__(self, channels: int, width: int) -> None:
        super().__init__()
        groups = min(8, width // 4)
        self.first = nn.Sequential(nn.Conv2d(channels, width, 3, padding=1), nn.GroupNorm(groups, width), nn.GELU())
        self.second = nn.Sequential(nn.Conv2d(width, width, 3, padding=1), nn.GroupNorm(groups, width))

    def forward(self, features: Tensor, modulation: Tensor) -> Tensor:
        scale, shift = modulation[..., None, None].chunk(2, dim=1)
        return nn.functional.gelu(self.second(self.first(features)) * (1 + scale) + shift)
