"""The cloth as a graph: points spread over what is seen of it, each tied to its nearest."""

from __future__ import annotations

import torch
from torch import Tensor, nn

NEIGHBOURS = 6
FEATURES = 4
SHARP = 1.5
"""How far a point's probability reaches [px]."""
NOWHERE = -30.0
"""Logarithm of what is left for what is not cloth."""


def spread(mask: Tensor, count: int) -> Tensor:
    """Pixels spread over masks, farthest first from those before, as indices into the flat picture, shape (N, count).

    Args:
        mask: bool, shape (N, S, S). Of one with fewer pixels some are named again; of an empty one the middle is.
        count: how many.
    """
    number, side, _ = mask.shape
    flat = mask.flatten(1)
    axis = torch.arange(side, device=mask.device, dtype=torch.float32)
    places = torch.stack(torch.meshgrid(axis, axis, indexing="ij")[::-1], dim=-1).reshape(-1, 2)
    nearest = torch.where(flat, torch.inf, -1.0)
    middle = side * side // 2 + side // 2
    nearest[:, middle] = torch.where(flat.any(1), nearest[:, middle], 0.0)
    found = torch.empty(number, count, dtype=torch.long, device=mask.device)
    for place in range(count):
        found[:, place] = nearest.argmax(1)
        apart = ((places[None] - places[found[:, place]][:, None]) ** 2).sum(-1)
        nearest = torch.minimum(nearest, apart)
    return found


class Graph(nn.Module):
    """Features of points from where they are, how high, and what is next to them.

    Args:
        width: of a point's features.
        rounds: of messages between neighbours.
    """

    def __init__(self, width: int, rounds: int = 2) -> None:
        super().__init__()
        self.first = nn.Sequential(nn.Linear(FEATURES, width), nn.GELU(), nn.Linear(width, width))
        self.messages = nn.ModuleList(
            nn.Sequential(nn.Linear(2 * width + 3, width), nn.GELU(), nn.Linear(width, width)) for _ in range(rounds)
        )
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(rounds))

    def forward(self, places: Tensor, heights: Tensor, side: int) -> Tensor:
        """Features, shape (N, K, width).

        Args:
            places: of points [px], shape (N, K, 2).
            heights: as frames have them, shape (N, K).
            side: of the picture [px].
        """
        at = places / side - 0.5
        edge = torch.stack([at.abs().amax(-1), heights], dim=-1)
        features = self.first(torch.cat([at, edge], dim=-1))
        near = torch.cdist(at, at).topk(min(NEIGHBOURS + 1, at.shape[1]), largest=False).indices[..., 1:]
        between = torch.cat(
            [gathered(at, near) - at[:, :, None], (gathered(heights[..., None], near) - heights[..., None, None])], -1
        )
        for message, norm in zip(self.messages, self.norms, strict=True):
            own = features[:, :, None].expand(-1, -1, near.shape[2], -1)
            told = message(torch.cat([own, gathered(features, near), between], dim=-1))
            features = norm(features + told.mean(2))
        return features


def gathered(values: Tensor, near: Tensor) -> Tensor:
    """Values, shape (N, K, C), of each point's neighbours, shape (N, K, M, C)."""
    count, points, many = near.shape
    flat = near.reshape(count, -1, 1).expand(-1, -1, values.shape[-1])
    return values.gather(1, flat).reshape(count, points, many, -1)


def as_map(logits: Tensor, places: Tensor, mask: Tensor) -> Tensor:
    """Logits of points as a map whose pixels' probabilities add up to those of the points they are nearest to.

    Args:
        logits: shape (N, A, K).
        places: of the points [px], shape (N, K, 2).
        mask: the cloth, bool, shape (N, S, S); elsewhere nothing is likely.

    Returns:
        Shape (N, A, S, S); highest, for each point, where it is.
    """
    number, side, _ = mask.shape
    axis = torch.arange(side, device=mask.device, dtype=places.dtype)
    pixels = torch.stack(torch.meshgrid(axis, axis, indexing="ij")[::-1], dim=-1).reshape(1, -1, 2)
    apart, owner = torch.cdist(pixels.expand(number, -1, -1), places).min(-1)
    sharp = torch.where(mask.flatten(1), -0.5 * (apart / SHARP) ** 2, NOWHERE)
    # Of each point's pixels the probabilities add up to the point's.
    whole = torch.full(logits.shape[::2], 0.0, device=logits.device).scatter_add(1, owner, sharp.exp())
    spread_over = sharp - whole.clamp_min(1e-6).log().gather(1, owner)
    maps = logits.gather(2, owner[:, None].expand(-1, logits.shape[1], -1)) + spread_over[:, None]
    return maps.reshape(number, -1, side, side)
