"""Values of drags: how likely each drag of each pixel is to turn the cloth into the goal.

R. Lee et al., Learning Arbitrary-Goal Fabric Folding with One Hour of Real Robot Experience, CoRL 2020,
arXiv:2010.03209.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from polyfold_baselines.demos.drags import drags
from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning.networks.network import Floats, Network

MAP = SIDE // 2
CHANNELS = 2


class DragValues(Network):
    """The cloth and its goal to a map of values for every drag: convolutions alone.

    Args:
        width: of the deepest features.
        depth: levels below the first; each halves the picture.
    """

    def __init__(self, width: int = 128, depth: int = 4) -> None:
        super().__init__()
        self.arms = 1
        widths = [max(16, width >> (depth - level)) for level in range(depth + 1)]
        self.down = nn.ModuleList(_level(a, b) for a, b in zip([2 * CHANNELS, *widths[:-1]], widths, strict=True))
        self.up = nn.ModuleList(_level(a + b, b) for a, b in zip(widths[:0:-1], widths[-2::-1], strict=True))
        self.out = nn.Conv2d(widths[0], len(drags()), 1)
        self.register_buffer("ways", torch.from_numpy(drags().astype(np.float32)), persistent=False)

    def forward(self, now: Tensor, wanted: Tensor) -> Tensor:
        """Logits of values, shape (N, drags, SIDE / 2, SIDE / 2), of cloth and goal, (N, CHANNELS, SIDE, SIDE) each."""
        features, kept = functional.avg_pool2d(torch.cat([now, wanted], dim=1), 2), list[Tensor]()
        for number, level in enumerate(self.down):
            features = level(functional.max_pool2d(features, 2) if number else features)
            kept.append(features)
        for level, beside in zip(self.up, kept[-2::-1], strict=True):
            larger = functional.interpolate(features, scale_factor=2.0, mode="bilinear", align_corners=False)
            features = level(torch.cat([larger, beside], dim=1))
        return self.out(features)

    def loss(self, now: Tensor, wanted: Tensor, points: Tensor) -> Tensor:
        """What was reached is a goal that the drag reaches, and what another drag reached is one that it does not."""
        drag, pixel = self._done(points)
        likely, unlikely = (self._of(self(now, goal), drag, pixel) for goal in (wanted, wanted.roll(1, dims=0)))
        ones, zeros = torch.ones_like(likely), torch.zeros_like(unlikely)
        of_right = functional.binary_cross_entropy_with_logits(likely, ones)
        of_wrong = functional.binary_cross_entropy_with_logits(unlikely, zeros)
        return of_right + of_wrong

    def read(self, logits: Tensor, masks: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """The best drag of a pixel of the cloth, as pick and place [px of the view], shape (N, 1, 2) each."""
        cloth = functional.avg_pool2d(torch.from_numpy(masks).float()[:, None], 2).to(logits.device) > 0.5
        best = logits.float().masked_fill(~cloth, -torch.inf).flatten(1).argmax(1).cpu()
        drag, pixel = best // MAP**2, best % MAP**2
        picks = 2.0 * torch.stack([pixel % MAP, pixel // MAP], dim=-1).double() + 0.5
        places = picks + torch.from_numpy(drags())[drag]
        return picks[:, None].numpy(), places[:, None].numpy()

    def _done(self, points: Tensor) -> tuple[Tensor, Tensor]:
        """Which drag, and which pixel of the flat map, each was nearest to, shape (N,)."""
        picks, places = points[:, 0, 0], points[:, 0, 1]
        drag = torch.cdist(places - picks, self.get_buffer("ways")).argmin(1)
        column, row = ((picks - 0.5) / 2).round().long().clamp(0, MAP - 1).unbind(-1)
        return drag, row * MAP + column

    @staticmethod
    def _of(logits: Tensor, drag: Tensor, pixel: Tensor) -> Tensor:
        return logits.float().flatten(2)[torch.arange(len(drag), device=logits.device), drag, pixel]


def _level(channels: int, width: int) -> nn.Module:
    groups = min(8, width // 4)
    return nn.Sequential(
        nn.Conv2d(channels, width, 3, padding=1), nn.GroupNorm(groups, width), nn.GELU(),
        nn.Conv2d(width, width, 3, padding=1), nn.GroupNorm(groups, width), nn.GELU(),
    )  # fmt: skip
