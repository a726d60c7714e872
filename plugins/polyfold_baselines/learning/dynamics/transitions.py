"""Random drags as graphs: where nodes were, which near ones are joined, what was dragged, where the nodes came to lie.

What is true of a node is what is true of the particle under it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from polyfold_baselines.demos.cloths import Cloth
from polyfold_baselines.demos.demonstrating import PER_METRE, Arrays, unpacked
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import SIDE, in_view, on_table
from polyfold_baselines.learning.dynamics.graphs import inside, nearest_of, nodes_of
from polyfold_baselines.learning.examples import held_out

Floats = NDArray[np.float64]

BELOW = 2e-4
"""A particle that is farther below what is seen there is under another ply [m]: half of the thinnest cloth."""
LONGER, SLACK = 1.5, 0.01
"""Nodes are joined if the way along the cloth is no more than so many times as long, and so much [m], as straight."""


@dataclass(frozen=True, eq=False)
class Transitions:
    """N drags of K nodes, each with its M nearest, on the table from the view's middle [m].

    Attributes:
        nodes: before the drag, float32, shape (N, K, 3).
        near: which are near each, int16, shape (N, K, M).
        joined: whether those are joined with it by a way along the cloth that is about as short, bool, shape (N, K, M).
        picks, places: of the drag, float32, shape (N, 2).
        ends: where the nodes came to lie, float32, shape (N, K, 3).
        extents: side of the view on the table [m], float32, shape (N,).
    """

    nodes: Tensor
    near: Tensor
    joined: Tensor
    picks: Tensor
    places: Tensor
    ends: Tensor
    extents: Tensor

    def __len__(self) -> int:
        return len(self.nodes)

    def of(self, chosen: NDArray[np.int64], device: torch.device) -> Transitions:
        """Some of them, on a device."""
        return Transitions(*(getattr(self, field.name)[chosen].to(device) for field in fields(self)))


def make_transitions(demos: Demos, progress: bool = True) -> tuple[Transitions, Transitions]:
    """Drags to learn from, and those of garments held out, without those of cloth that had been dragged out of view.

    Raises:
        ConfigError: if no particles were kept, or all drags are of one garment.
    """
    from tqdm.auto import tqdm

    in_sight: NDArray[np.bool_] = np.any(demos.columns["mask"], axis=1)
    apart = held_out(demos)[in_sight]
    found: list[Arrays] = []
    with tqdm(total=len(demos), unit="graph", disable=not progress) as bar:
        for cloth in demos.cloths():
            columns = {name: values[cloth.rows] for name, values in demos.columns.items()}
            found += [_transition(cloth, columns, int(step)) for step in np.flatnonzero(in_sight[cloth.rows])]
            bar.update(len(columns["step"]))
    every = {name: np.stack([one[name] for one in found]) for name in found[0]}
    learned, held = (
        Transitions(**{name: torch.from_numpy(values[rows]) for name, values in every.items()})
        for rows in (~apart, apart)
    )
    return learned, held


def _transition(cloth: Cloth, columns: Arrays, step: int) -> Arrays:
    heights = columns["height"][step] / PER_METRE
    mask = unpacked(columns["mask"][step][None])[0]
    nodes = nodes_of(heights, mask, cloth.extent)
    near = nearest_of(nodes)
    before, after = cloth.particles[step : step + 2]
    under = _under(nodes, before, _seen(before, heights, mask, cloth.extent))
    straight = np.linalg.norm(before[under][:, None] - before[under[near]], axis=-1)
    along = cloth.apart_at_rest(np.broadcast_to(under[:, None], near.shape), under[near])
    return {
        "nodes": nodes.astype(np.float32), "near": near.astype(np.int16), "joined": along <= LONGER * straight + SLACK,
        "picks": on_table(columns["picks"][step, 0], cloth.extent).astype(np.float32),
        "places": on_table(columns["places"][step, 0], cloth.extent).astype(np.float32),
        "ends": (nodes + after[under] - before[under]).astype(np.float32),
        "extents": np.array(cloth.extent, np.float32),
    }  # fmt: skip


def _seen(particles: Floats, heights: NDArray, mask: NDArray[np.bool_], extent: float) -> NDArray[np.int64]:
    """Which particles lie under no other ply; all if that can't be told of any."""
    import cv2

    # The lowest of the pixels about it: next to a step, what lies below is seen as well.
    lowest = cv2.erode(np.where(inside(mask), heights, np.inf), np.ones((3, 3), np.uint8))
    column, row = in_view(particles[:, :2], extent).round().astype(int).clip(0, SIDE - 1).T
    seen = np.flatnonzero(particles[:, 2] >= lowest[row, column] - BELOW)
    return seen if len(seen) else np.arange(len(particles))


def _under(nodes: Floats, particles: Floats, seen: NDArray[np.int64]) -> NDArray[np.int64]:
    """The nearest of the particles that are seen to each node."""
    from scipy.spatial import KDTree

    return seen[KDTree(particles[seen]).query(nodes)[1]]
