"""Tethers: no particle gets farther from a gripper than the cloth between them is long.

One sweep over the edges per substep leaves cloth that hangs between two grippers several percent too long, enough for
its middle to sag by a hand's breadth. Tethers (Kim et al. 2012, "long range attachments") take that away for the price
of one comparison per particle and arm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh

if TYPE_CHECKING:
    from scipy.sparse import csr_array

DETOUR = 1.04
"""A path along edges and across pairs of triangles is at most this much longer than the straight one."""
SLACK = 1.002


class Tethers(NamedTuple):
    """How far the cloth reaches from what is held.

    Attributes:
        particles, anchors: indices, uint32, shape (K,).
        lengths: longest distance between them [m], float32, shape (K,).
    """

    particles: NDArray[np.uint32]
    anchors: NDArray[np.uint32]
    lengths: NDArray[np.float32]


class TetherMap:
    """Distances within each panel of a garment."""

    def __init__(self, mesh: Mesh) -> None:
        self._flat = np.asarray(mesh.vertices, float)[:, :2]
        self._layer, self._seam = np.asarray(mesh.layer), np.asarray(mesh.seam)
        self._graphs = [self._graph(np.asarray(mesh.triangles)[mesh.panel == panel]) for panel in range(mesh.layers)]

    def tie(self, held: NDArray[np.uint32], arms: NDArray[np.uint32], offsets: NDArray[np.float32]) -> Tethers:
        """Tethers from each arm's innermost held particle of a panel to the panel's particles."""
        from scipy.sparse.csgraph import dijkstra

        particles, anchors, lengths = [], [], []
        for arm in np.unique(arms):
            for panel, graph in enumerate(self._graphs):
                usable = (arms == arm) & ((self._layer[held] == panel) | self._seam[held])
                if not usable.any():
                    continue
                nearest = np.flatnonzero(usable)[np.hypot(*offsets[usable, :2].T).argmin()]
                anchor = int(held[nearest])
                members = np.flatnonzero((self._layer == panel) & (np.arange(len(self._flat)) != anchor))
                along = dijkstra(graph, indices=anchor)[members] / DETOUR
                straight = np.hypot(*(self._flat[members] - self._flat[anchor]).T)
                particles.append(members)
                anchors.append(np.full(len(members), anchor))
                lengths.append(SLACK * np.maximum(along, straight))
        reach = np.concatenate(lengths)
        known = np.isfinite(reach)
        return Tethers(
            np.concatenate(particles)[known].astype(np.uint32),
            np.concatenate(anchors)[known].astype(np.uint32),
            reach[known].astype(np.float32),
        )

    def _graph(self, triangles: NDArray[np.int32]) -> csr_array:
        """Edges and the diagonals across them, weighted by length."""
        from scipy.sparse import csr_array

        count = len(self._flat)
        a = np.concatenate([triangles[:, k] for k in (0, 1, 2, 1, 2, 0)])
        b = np.concatenate([triangles[:, k] for k in (1, 2, 0, 0, 1, 2)])
        edges = csr_array((np.ones(len(a)), (a, b)), shape=(count, count))
        near = ((edges @ edges) + edges).tocoo()
        apart = near.row != near.col
        row, col = near.row[apart], near.col[apart]
        return csr_array((np.hypot(*(self._flat[row] - self._flat[col]).T), (row, col)), shape=(count, count))
