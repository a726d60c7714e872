"""Two graph networks: which near nodes are joined on the cloth, and where all of them lie after a drag.

X. Lin, Y. Wang, Z. Huang and D. Held, Learning Visible Connectivity Dynamics for Cloth Smoothing, CoRL 2021,
arXiv:2105.10389. Nodes are encoded, told of each other again and again, and decoded, as in A. Sanchez-Gonzalez et al.,
Learning to Simulate Complex Physics with Graph Networks, ICML 2020, arXiv:2002.09405. In plain torch: all graphs have
as many nodes, and all nodes as many neighbours, so that messages are dense tensors and nothing is scattered.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from polyfold_baselines.learning.dynamics.graphs import nearest_of
from polyfold_baselines.learning.dynamics.transitions import Transitions
from polyfold_baselines.learning.networks.nodes import gathered

Floats = NDArray[np.float64]

PLY = 5e-4
"""About the thickness of a cloth [m]: of heights, steps as small are told as clearly as loops of centimetres."""
GRIP = 0.015
"""Nodes that are so near to a pick are gripped [m]; the nearest is, however far."""
FINE = 10.0
"""Ways between neighbours are a tenth of the view or less."""
AT_ONCE = 64
"""Drags that are predicted together."""
NODE, EDGE, JOINT = 7, 5, 4


class VisibleDynamics(nn.Module):
    """Nodes of the cloth and a drag to where the nodes come to lie.

    Lengths are taken as shares of the view's side and heights in plies; ways are seen along the drag, so that it does
    not matter where the cloth lies and which way it is dragged.

    Args:
        width: of a node's features.
        depth: rounds of messages.
    """

    def __init__(self, width: int = 64, depth: int = 6) -> None:
        super().__init__()
        self.connecting = _Rounds(1, JOINT, width, max(1, depth // 2))
        self.joint, self.joins = _Messages(JOINT, width), nn.Linear(width, 1)
        self.moving = _Rounds(NODE, EDGE, width, depth)
        self.way = nn.Sequential(nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 3))

    def joined(self, nodes: Tensor, near: Tensor, extents: Tensor) -> Tensor:
        """Logits of whether nodes are joined with those near them, shape (N, K, M), of Transitions' values."""
        ways = (gathered(nodes, near) - nodes[:, :, None]) / extents[:, None, None, None]
        flat = FINE * ways[..., :2]
        step = _plies(gathered(nodes, near)[..., 2:] - nodes[:, :, None, 2:])
        between = torch.cat([flat, flat.norm(dim=-1, keepdim=True), step], dim=-1)
        features = self.connecting(_plies(nodes[..., 2:]), near, between)
        return self.joins(self.joint(features, near, between))[..., 0]

    def ends(
        self, nodes: Tensor, near: Tensor, joined: Tensor, picks: Tensor, places: Tensor, extents: Tensor
    ) -> Tensor:
        """Where nodes come to lie [m], shape (N, K, 3).

        Args:
            nodes, near, picks, places, extents: as :class:`Transitions` has them.
            joined: how likely near ones are joined, shape (N, K, M).
        """
        scale = extents[:, None, None]
        drag = (places - picks) / extents[:, None]
        length = drag.norm(dim=-1, keepdim=True)
        turn = _turn(drag / length.clamp_min(1e-6))
        offset = (nodes[..., :2] - picks[:, None]) / scale @ turn
        whole = torch.cat([length, extents[:, None]], dim=-1)[:, None].expand(-1, nodes.shape[1], -1)
        gripped = self.gripped(nodes, picks).float()[..., None]
        told = torch.cat([_plies(nodes[..., 2:]), offset, offset.norm(dim=-1, keepdim=True), gripped, whole], dim=-1)
        ways = FINE * (gathered(nodes, near) - nodes[:, :, None])[..., :2] / scale[..., None] @ turn[:, None]
        step = _plies(gathered(nodes, near)[..., 2:] - nodes[:, :, None, 2:])
        between = torch.cat([ways, ways.norm(dim=-1, keepdim=True), step, joined[..., None]], dim=-1)
        moved = self.way(self.moving(told, near, between))
        return nodes + scale * torch.cat([moved[..., :2] @ turn.transpose(1, 2), moved[..., 2:]], dim=-1)

    @staticmethod
    def gripped(nodes: Tensor, picks: Tensor) -> Tensor:
        """Which nodes, shape (N, K, 3), picks grip, shape (N, 2); bool, shape (N, K)."""
        apart = (nodes[..., :2] - picks[:, None]).norm(dim=-1)
        return (apart <= GRIP) | (apart == apart.amin(-1, keepdim=True))

    def predicted(self, drags: Transitions) -> tuple[Tensor, Tensor]:
        """Logits of what is joined, and where the nodes of drags come to lie with what is likely joined."""
        near = drags.near.long()
        logits = self.joined(drags.nodes, near, drags.extents)
        likely = logits.detach().sigmoid()
        return logits, self.ends(drags.nodes, near, likely, drags.picks, drags.places, drags.extents)

    def loss(self, drags: Transitions) -> Tensor:
        """Of both networks; neither learns through the other."""
        logits, ends = self.predicted(drags)
        wrong = (ends - drags.ends) / drags.extents[:, None, None]
        of_ends = functional.smooth_l1_loss(wrong, torch.zeros_like(wrong), beta=0.02)
        of_edges = functional.binary_cross_entropy_with_logits(logits, drags.joined.float(), reduction="none")
        return FINE * of_ends + evenly(of_edges, drags.joined)

    @torch.inference_mode()
    def lands(self, nodes: Floats, picks: Floats, places: Floats, extent: float) -> Floats:
        """Where the nodes of one cloth come to lie after each of several drags [m], shape (C, K, 3).

        Args:
            nodes: shape (K, 3), see :func:`polyfold_baselines.learning.dynamics.graphs.nodes_of`.
            picks, places: shape (C, 2).
            extent: side of the view on the table [m].
        """
        device = next(self.parameters()).device
        cloth = torch.tensor(nodes, dtype=torch.float32, device=device)[None]
        near = torch.from_numpy(nearest_of(nodes)).to(device)[None]
        size = torch.full((1,), extent, device=device)
        likely = self.joined(cloth, near, size).sigmoid()
        found = []
        for part in np.array_split(np.arange(len(picks)), math.ceil(len(picks) / AT_ONCE)):
            many = len(part)
            same = cloth.expand(many, -1, -1), near.expand(many, -1, -1), likely.expand(many, -1, -1)
            pick, place = (torch.tensor(points[part], dtype=torch.float32, device=device) for points in (picks, places))
            found.append(self.ends(*same, pick, place, size.expand(many)).double().cpu().numpy())
        return np.concatenate(found)


class _Rounds(nn.Module):
    """Features of nodes that are told of their neighbours' again and again."""

    def __init__(self, node: int, edge: int, width: int, rounds: int) -> None:
        super().__init__()
        self.first = nn.Sequential(nn.Linear(node, width), nn.ReLU(), nn.Linear(width, width))
        self.rounds = nn.ModuleList(_Round(edge, width) for _ in range(rounds))

    def forward(self, told: Tensor, near: Tensor, between: Tensor) -> Tensor:
        """Of what is told of nodes, shape (N, K, node), and between them, shape (N, K, M, edge)."""
        features = self.first(told)
        for one in self.rounds:
            features = one(features, near, between)
        return features


class _Round(nn.Module):
    """A message from each neighbour, of which a node takes the mean."""

    def __init__(self, edge: int, width: int) -> None:
        super().__init__()
        self.messages = _Messages(edge, width)
        self.after = nn.Sequential(nn.Linear(2 * width, width), nn.ReLU(), nn.Linear(width, width))
        self.norm = nn.LayerNorm(width)

    def forward(self, features: Tensor, near: Tensor, between: Tensor) -> Tensor:
        told = self.messages(features, near, between).mean(2)
        return self.norm(features + self.after(torch.cat([features, told], dim=-1)))


class _Messages(nn.Module):
    """A layer over a node, a neighbour and what is between them, shape (N, K, M, width).

    It is taken apart into its three parts, two of which cost as much as nodes and not as edges.
    """

    def __init__(self, edge: int, width: int) -> None:
        super().__init__()
        self.own, self.other, self.between = nn.Linear(width, width), nn.Linear(width, width), nn.Linear(edge, width)

    def forward(self, features: Tensor, near: Tensor, between: Tensor) -> Tensor:
        own, other = self.own(features)[:, :, None], gathered(self.other(features), near)
        return functional.relu(own + other + self.between(between))


def evenly(values: Tensor, joined: Tensor) -> Tensor:
    """The mean over joined and that over other edges, which are far fewer, count the same."""
    both = [(values * part).sum() / part.sum().clamp_min(1) for part in (joined, ~joined)]
    return (both[0] + both[1]) / 2


def _plies(heights: Tensor) -> Tensor:
    return torch.asinh(heights / PLY) / 4


def _turn(along: Tensor) -> Tensor:
    """What ways are multiplied by from the right to have ``along``, shape (N, 2), as their first axis."""
    x, y = along.unbind(-1)
    return torch.stack([torch.stack([x, -y], -1), torch.stack([y, x], -1)], -2)
