"""The garment that a simulator drapes: a flat triangle mesh in one or two layers with named keypoints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold._brief import brief
from polyfold.garments._fabric import UNCHOSEN, Fabric


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """A garment at rest, spread flat: one panel, or two panels that share their seam vertices.

    Attributes:
        vertices: rest positions [m], shape (N, 2), garment upright (x right, y up), centred on the origin.
        triangles: vertex indices, int32, shape (T, 3), counter-clockwise seen from above.
        panel: panel of each triangle, int8, shape (T,): 0 lies on the table, 1 on top of it.
        layer: layer of each vertex, int8, shape (N,): 0 on the table (seam vertices too), 1 on top.
        seam: which vertices belong to both panels, bool, shape (N,); all False for one layer.
        boundary: vertex indices of the silhouette in order, int32, shape (B,), counter-clockwise seen from above.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    panel: NDArray[np.int8]
    layer: NDArray[np.int8]
    seam: NDArray[np.bool_]
    boundary: NDArray[np.int32]

    __repr__ = brief

    @property
    def layers(self) -> int:
        """1 for a cloth, 2 for a garment with a front and a back."""
        return int(self.panel.max()) + 1

    def renumbered(self, order: NDArray[np.int64]) -> Mesh:
        """The same mesh with its vertices in another order, int, shape (N,): vertex k is what ``order[k]`` was."""
        number = np.argsort(order).astype(np.int32)
        return Mesh(
            self.vertices[order],
            number[self.triangles],
            self.panel,
            self.layer[order],
            self.seam[order],
            number[self.boundary],
        )


@dataclass(frozen=True, eq=False, repr=False)
class Garment:
    """One garment: its mesh, its named ground-truth keypoints, its looks and its fabric.

    Attributes:
        kind: a registered garment kind, e.g. ``tshirt``; selects the polygon template. (Elsewhere ``kind`` may mean a
            kind of component: see :mod:`polyfold.plugins`.)
        name: unique name, e.g. ``tshirt-0007``.
        seed: the seed it was generated from, or None for a file or a twin.
        mesh: the mesh at rest.
        keypoints: keypoint name -> vertex index; the names are the template's vertex names.
        colours: outside and inside colour, RGB in 0..255.
        cyclic: keypoint names in polygon order, starting at bottom_left, for shapes whose naming depends on how they
            lie (square, rectangle): at reset the edge nearest the image's top becomes the top. Empty otherwise.
        fabric: what it is made of. Generators need not give one: :func:`polyfold.garment` and
            :func:`polyfold.plugins.generate_garment` put the chosen one in. Poplin until then.
        angle_deg: how far a simulator turns it when it lays it, counter-clockwise as the camera sees it; None where the
            simulator draws that from its seed. The twin of a real garment lies as that did.
        photo: the photograph that it is the twin of, as the twin's camera would see it, uint8, shape (H, W, 3).
    """

    kind: str
    name: str
    seed: int | None
    mesh: Mesh
    keypoints: Mapping[str, int]
    colours: tuple[tuple[int, int, int], tuple[int, int, int]] = ((66, 133, 180), (214, 204, 190))
    cyclic: tuple[str, ...] = ()
    fabric: Fabric = UNCHOSEN
    angle_deg: float | None = None
    photo: NDArray[np.uint8] | None = None

    __repr__ = brief
