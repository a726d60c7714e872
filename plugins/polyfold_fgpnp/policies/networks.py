"""The value networks: a UNet over the partial mask whose map tells, for every pixel, how well a fold will come out."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import torch
from pydantic import BaseModel, ConfigDict, Field
from torch import Tensor, nn
from torch.nn import functional

from polyfold_fgpnp.policies.pairs import GEOMETRY

Variant = Literal["csam", "pair", "1sam", "2sam", "vertex-learned"]

SLOPE = 0.1
"""Of the leaky rectifier: with a plain one and single-pixel supervision the network collapses to a constant."""

FREQUENCIES = 8
"""Octaves of the positional encoding of the fold line (Mildenhall et al. 2020)."""

CHANNELS = {"canonical": 2, "camera": 1}


class NetworkConfig(BaseModel):
    """Shape of a value network."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    variant: Variant = Field(default="csam", description="what its values mean")
    frame: Literal["canonical", "camera"] = Field(default="canonical", description="how it sees the flap")
    base: int = Field(default=16, ge=4, le=128, description="channels of the first level")
    levels: int = Field(default=4, ge=2, le=6, description="levels of resolution")
    features: int = Field(default=16, ge=4, le=64, description="channels of the map that the pair head reads")

    @property
    def stem(self) -> int:
        """Pixels along a side that become channels at the input, and come back at the output."""
        return 2 if self.frame == "canonical" else 4

    @property
    def maps(self) -> int:
        """Channels of the output."""
        return {"2sam": 2, "pair": self.features}.get(self.variant, 1)


class ValueNetwork(nn.Module):
    """UNet (Ronneberger et al. 2015), in the camera frame conditioned on the fold line by FiLM (Perez et al. 2018).

    Values are standardised labels: 0 is the mean over the training data, higher is better.
    """

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.config = config
        stem, widths = config.stem, [config.base * 2**level for level in range(config.levels)]
        conditions = 4 * 2 * FREQUENCIES if config.frame == "camera" else 0
        self.entry = _Block((CHANNELS[config.frame] + 2) * stem**2, widths[0], conditions)
        self.down = nn.ModuleList(_Block(a, b, conditions) for a, b in pairwise(widths))
        self.up = nn.ModuleList(_Block(a + b, a, conditions) for a, b in pairwise(widths))
        self.exit = nn.Conv2d(widths[0], config.maps * stem**2, 1)
        if config.variant == "pair":
            self.head = _PairHead(config.features)
        else:
            nn.init.zeros_(self.exit.weight)
            nn.init.zeros_(self.exit.bias)  # pyright: ignore[reportArgumentType]  (None only without bias)

    def forward(self, images: Tensor, lines: Tensor) -> Tensor:
        """Maps, shape (B, maps, H, W), of images in 0..1, shape (B, C, H, W), and lines, shape (B, 4)."""
        condition = _encoded(lines) if self.config.frame == "camera" else None
        height, width = images.shape[-2:]
        multiple = self.config.stem * 2 ** len(self.down)
        x = functional.pad(torch.cat([images, _coordinates(images)], 1), (0, -width % multiple, 0, -height % multiple))
        x = self.entry(functional.pixel_unshuffle(x, self.config.stem), condition)
        passed = []
        for block in self.down:
            passed.append(x)
            x = block(functional.max_pool2d(x, 2), condition)
        for block, skip in zip(reversed(self.up), reversed(passed), strict=True):
            x = block(torch.cat([skip, functional.interpolate(x, scale_factor=2.0)], 1), condition)
        return functional.pixel_shuffle(self.exit(x), self.config.stem)[..., :height, :width]

    def values(self, maps: Tensor, points: Tensor, geometry: Tensor) -> Tensor:
        """Values of trials, shape (B, K, V), whose two picks are at points of the maps [px], shape (B, K, 2, 2).

        ``geometry``, shape (B, K, GEOMETRY), is what :func:`pair_geometry` says of them; only ``pair`` reads it.

        V is 1, but 2 for ``2sam``, whose two maps value a pick each.
        """
        if self.config.variant == "pair":
            return self.head(sampled(maps, points[:, :, 0]), sampled(maps, points[:, :, 1]), geometry)
        if self.config.variant == "2sam":
            return torch.cat([sampled(maps[:, k : k + 1], points[:, :, k]) for k in (0, 1)], -1)
        return sampled(maps, points[:, :, 0])


def sampled(maps: Tensor, points: Tensor) -> Tensor:
    """Bilinear values of maps, shape (B, C, H, W), at pixels, shape (B, K, 2): shape (B, K, C)."""
    size = torch.tensor([maps.shape[-1], maps.shape[-2]], dtype=points.dtype, device=points.device)
    grid = (2 * points + 1) / size - 1
    found = functional.grid_sample(maps.float(), grid[:, :, None], padding_mode="border", align_corners=False)
    return found[..., 0].transpose(1, 2)


class _Block(nn.Module):
    """Two convolutions; with a condition, the result is scaled and shifted by it channel by channel."""

    def __init__(self, entering: int, leaving: int, conditions: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(entering, leaving, 3, padding=1, bias=False)
        self.second = nn.Conv2d(leaving, leaving, 3, padding=1, bias=False)
        self.norms = nn.ModuleList(nn.BatchNorm2d(leaving) for _ in range(2))
        self.film = nn.Linear(conditions, 2 * leaving) if conditions else None

    def forward(self, x: Tensor, condition: Tensor | None) -> Tensor:
        x = functional.leaky_relu(self.norms[0](self.first(x)), SLOPE)
        x = self.norms[1](self.second(x))
        if self.film is not None and condition is not None:
            scale, shift = self.film(condition)[..., None, None].chunk(2, 1)
            x = x * (1 + scale) + shift
        return functional.leaky_relu(x, SLOPE)


class _PairHead(nn.Module):
    """The value of two picks together, the same whichever is named first."""

    def __init__(self, features: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Linear(3 * features + GEOMETRY, 64), nn.LeakyReLU(SLOPE), nn.Linear(64, 64), nn.LeakyReLU(SLOPE)
        )
        self.exit = nn.Linear(64, 1)
        nn.init.zeros_(self.exit.weight)
        nn.init.zeros_(self.exit.bias)

    def forward(self, first: Tensor, second: Tensor, geometry: Tensor) -> Tensor:
        return self.exit(self.layers(torch.cat([first + second, first * second, (first - second).abs(), geometry], -1)))


def _coordinates(images: Tensor) -> Tensor:
    """Two channels with x and y in 0..1."""
    height, width = images.shape[-2:]
    x = torch.linspace(0, 1, width, device=images.device).expand(height, width)
    y = torch.linspace(0, 1, height, device=images.device)[:, None].expand(height, width)
    return torch.stack([x, y]).to(images.dtype).expand(len(images), 2, height, width)


def _encoded(lines: Tensor) -> Tensor:
    octaves = 2.0 ** torch.arange(FREQUENCIES, device=lines.device) * torch.pi
    angles = (lines[..., None] * octaves).flatten(1)
    return torch.cat([angles.sin(), angles.cos()], -1)
