"""A sentence's tokens, patches of depth and the nodes of a graph in one transformer: picks at nodes, places as maps.

Y. Deng, K. Mo, C. Xia and X. Wang, Learning Language-Conditioned Deformable Object Manipulation with Graph Dynamics,
ICRA 2024, arXiv:2303.01310.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning import sentences
from polyfold_baselines.learning.networks import nodes
from polyfold_baselines.learning.networks.network import Network

PATCH = 8
GRID = SIDE // PATCH
CHANNELS = 2
NODES = 100
MAP = SIDE // 2


class LanguageGraph(Network):
    """The cloth and a sentence to heatmaps of picks and places.

    Args:
        arms: 1 or 2.
        width: of a token's features.
        depth: layers of the transformer.
        heads: of each attention.
    """

    def __init__(self, arms: int, width: int = 192, depth: int = 4, heads: int = 4) -> None:
        super().__init__()
        self.arms = arms
        self.stem = nn.Sequential(nn.Conv2d(CHANNELS, 16, 3, padding=1), nn.GELU(), nn.Conv2d(16, 32, 2, 2), nn.GELU())
        self.embed = nn.Conv2d(32, width, PATCH // 2, PATCH // 2)
        self.place = nn.Parameter(torch.zeros(1, GRID * GRID, width))
        nn.init.trunc_normal_(self.place, std=0.02)
        self.hear = nn.Linear(sentences.WIDTH, width)
        self.graph = nodes.Graph(width)
        layer = nn.TransformerEncoderLayer(
            width, heads, 4 * width, dropout=0.0, activation="gelu", batch_first=True, norm_first=True
        )
        self.together = nn.TransformerEncoder(layer, depth, nn.LayerNorm(width), enable_nested_tensor=False)
        self.pick = nn.Linear(width, arms)
        self.up = nn.Sequential(
            nn.ConvTranspose2d(width, 64, 2, 2), nn.GELU(), nn.ConvTranspose2d(64, 32, 2, 2), nn.GELU()
        )
        self.fuse = nn.Sequential(nn.Conv2d(64, 32, 3, padding=1), nn.GELU(), nn.Conv2d(32, arms, 3, padding=1))

    def forward(self, now: Tensor, wanted: Tensor) -> Tensor:
        """Heatmaps, pick and place of each arm, shape (N, 2 arms, SIDE / 2, SIDE / 2).

        Args:
            now: the cloth, shape (N, CHANNELS, SIDE, SIDE).
            wanted: tokens of the sentence, shape (N, T, WIDTH).
        """
        count = len(now)
        smaller = nn.functional.avg_pool2d(now, 2)
        cloth = smaller[:, 1] > 0.5
        at = nodes.spread(cloth, NODES)
        places = torch.stack([at % MAP, at // MAP], dim=-1).float()
        points = self.graph(places, smaller[:, 0].flatten(1).gather(1, at).float(), MAP)
        shallow = self.stem(now)
        patches = self.embed(shallow).flatten(2).transpose(1, 2) + self.place
        words = self.hear(wanted)
        silent = torch.zeros(count, patches.shape[1] + NODES, dtype=torch.bool, device=now.device)
        ended = torch.cat([sentences.ends(wanted), silent], dim=1)
        tokens = self.together(torch.cat([words, patches, points], dim=1), src_key_padding_mask=ended)
        deep = tokens[:, words.shape[1] : -NODES].transpose(1, 2).reshape(count, -1, GRID, GRID)
        place_maps = self.fuse(torch.cat([self.up(deep), shallow], dim=1))
        pick_maps = nodes.as_map(self.pick(tokens[:, -NODES:]).transpose(1, 2).float(), places, cloth)
        return torch.stack([pick_maps, place_maps.float()], dim=2).flatten(1, 2)
