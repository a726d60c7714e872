"""Polygon generators: from skeletal parameters X to the polygon's vertices (paper, Sec. III-1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError

Floats = NDArray[np.float64]


@runtime_checkable
class Generator(Protocol):
    """Maps skeletal parameters, shape (P,), to vertices [px], shape (V, 2), anywhere in the image."""

    def parameters(self, vertices: Floats) -> Floats:
        """Parameters, shape (P,), whose polygon comes close to the given vertices [px], shape (V, 2)."""
        ...

    def vertices(self, parameters: Floats) -> Floats:
        """The polygon [px], shape (V, 2), of parameters of shape (P,)."""
        ...

    def jacobian(self, parameters: Floats) -> Floats:
        """Derivatives, shape (V, 2, P), of the vertices [px] at parameters of shape (P,)."""
        ...


class SymmetricGenerator:
    """Polygons that are mirror images of themselves: the parameters are a pose and one half of the outline.

    In order: centre x, centre y [px], heading [rad], then the coordinates of the symmetric shape [px]. A t-shirt, with
    six mirrored pairs and the neck on the axis, has 15 parameters; a rectangle, with two pairs, has 6.

    Args:
        names: vertex names in polygon order.
        pairs: (left, right) names of the vertices that mirror each other; a name in no pair lies on the axis.
    """

    def __init__(self, names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> None:
        index = {name: i for i, name in enumerate(names)}
        unknown = [name for pair in pairs for name in pair if name not in index]
        if unknown:
            raise GarmentError(f"pairs name unknown vertices {unknown}; the template has {', '.join(names)}")
        self._side = np.zeros(len(names))
        for left, right in pairs:
            self._side[index[left]], self._side[index[right]] = -1.0, 1.0
        self._basis = _symmetric_basis(index, pairs)

    def parameters(self, vertices: ArrayLike) -> Floats:
        """Pose and symmetric shape, shape (P,), closest to the given vertices [px], shape (V, 2)."""
        target = np.asarray(vertices, float)
        centre = target.mean(0)
        across = self._side @ (target - centre)
        heading = float(np.arctan2(across[1], across[0]))
        upright = (target - centre) @ _rotation(heading)
        shape = np.tensordot(upright, self._basis, axes=([0, 1], [0, 1]))
        return np.concatenate([centre, [heading], shape])

    def vertices(self, parameters: ArrayLike) -> Floats:
        """The polygon [px], shape (V, 2), of parameters of shape (P,)."""
        parameters = np.asarray(parameters, float)
        return (self._basis @ parameters[3:]) @ _rotation(parameters[2]).T + parameters[:2]

    def jacobian(self, parameters: ArrayLike) -> Floats:
        """Derivatives, shape (V, 2, P), of the vertices [px] at parameters of shape (P,)."""
        parameters = np.asarray(parameters, float)
        turn = _rotation(parameters[2])
        offsets = (self._basis @ parameters[3:]) @ turn.T
        jacobian = np.zeros((*offsets.shape, len(parameters)))
        jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1.0
        jacobian[:, 0, 2], jacobian[:, 1, 2] = -offsets[:, 1], offsets[:, 0]
        jacobian[:, :, 3:] = np.einsum("ij,vjp->vip", turn, self._basis)
        return jacobian


def _symmetric_basis(index: dict[str, int], pairs: Sequence[tuple[str, str]]) -> Floats:
    """Orthonormal directions of upright symmetric shapes centred on the origin, shape (V, 2, P)."""
    count, columns = len(index), []
    paired = {name for pair in pairs for name in pair}
    groups = [tuple(index[name] for name in pair) for pair in pairs]
    groups += [(i,) for name, i in index.items() if name not in paired]
    for left, right in (group for group in groups if len(group) == 2):
        column = np.zeros((count, 2))
        column[left, 0], column[right, 0] = -np.sqrt(0.5), np.sqrt(0.5)
        columns.append(column)
    heights = np.zeros((count, len(groups)))
    for k, group in enumerate(groups):
        heights[list(group), k] = 1.0
    # The common shift is the centre's business: keep what is orthogonal to it.
    directions, sizes, _ = np.linalg.svd(heights - heights.mean(0), full_matrices=False)
    for direction in directions.T[sizes > 1e-9]:
        columns.append(np.column_stack([np.zeros(count), direction]))
    return np.stack(columns, axis=-1)


def _rotation(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
