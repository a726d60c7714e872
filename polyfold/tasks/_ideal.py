"""The ideal fold: the true flat garment folded geometrically, and how near a simulated result came to it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment, Mesh
from polyfold.geometry import Camera, FoldLine, iou
from polyfold.geometry._masks import fill_polygon
from polyfold.polygon._covering import covered_area, overlap_area, shapes, solid_parts
from polyfold.polygon._layers import Facet, cut_facets
from polyfold.types import Outcome, SimState
from polyfold.types._fidelity import Fidelity, Reference

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

MOVED = 0.020
"""Particles that the ideal moves further than this [m] count as moved."""

TOUCHING = 9.0
"""Sheets that overlap by less than this [px²] do not lie on each other."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class IdealFold:
    """The garment after ideal folds.

    Attributes:
        positions: where each particle ends [m], shape (N, 3).
        layer: how many layers of cloth lie under each particle, shape (N,).
        mask: the silhouette as the camera sees it, bool, shape (H, W).
        depth: distance along the optical axis as the camera would measure it [m], float32, shape (H, W).
        area: silhouette on the table [px²].
    """

    positions: Floats
    layer: NDArray[np.int64]
    mask: NDArray[np.bool_]
    depth: NDArray[np.float32]
    area: float

    def outcome(self, flat: SimState, mesh: Mesh) -> Outcome:
        """As metrics want it, folded from the flat garment."""
        return Outcome(flat, replace(flat, positions=self.positions), self.mask, mesh)


@dataclass(frozen=True, eq=False)
class _Sheet:
    """The part of one panel that went through the same turns; all of it lies in one layer.

    Attributes:
        facets: its pieces; none where a fold left nothing of the panel on this side of the line.
        layer: how many layers of cloth lie under it.
    """

    facets: tuple[Facet, ...]
    layer: int

    @cached_property
    def shapes(self) -> list[BaseGeometry]:
        """The pieces as shapes, to find overlaps with."""
        return shapes(facet.polygon for facet in self.facets)


@dataclass(frozen=True, eq=False)
class _Stack:
    """The garment between two folds.

    Attributes:
        sheets: what it consists of.
        points: where each particle is [px, as if on the table], shape (N, 2).
        sheet_of: index of each particle's sheet, shape (N,).
    """

    sheets: list[_Sheet]
    points: Floats
    sheet_of: NDArray[np.int64]


def fold_ideally(flat: SimState, garment: Garment, lines: Sequence[FoldLine]) -> IdealFold:
    """Fold the flat garment along lines: everything left of a line is mirrored across it, as one rigid stack.

    Args:
        flat: the state before the first fold.
        garment: the garment; its mesh gives the silhouette and the layer of each particle, its fabric the thickness.
        lines: directed fold lines [px], in order.
    """
    stack = _flat_stack(flat, garment.mesh)
    for line in lines:
        stack = _folded(stack, line)
    return _as_seen(stack, flat, garment.fabric.thickness)


def fold_step_by_step(flat: SimState, garment: Garment, lines: Iterable[FoldLine]) -> list[IdealFold]:
    """Fold the flat garment along lines and keep what it is after each of them.

    Args: as in :func:`fold_ideally`.

    Returns:
        One ideal fold for each line; the last one is what :func:`fold_ideally` gives.
    """
    stack, found = _flat_stack(flat, garment.mesh), []
    for line in lines:
        stack = _folded(stack, line)
        found.append(_as_seen(stack, flat, garment.fabric.thickness))
    return found


def fidelity(
    final_mask: NDArray[np.bool_],
    final: SimState,
    flat: SimState,
    ideal: IdealFold,
    reference: Reference,
) -> Fidelity:
    """Compare a result with the ideal fold of the garment it started from.

    Args:
        final_mask: the cloth in the last picture, bool, shape (H, W).
        final: the state after the last fold.
        flat: the state before the first fold.
        ideal: that garment folded ideally.
        reference: who says that this was wanted.
    """
    travel = np.linalg.norm(ideal.positions[:, :2] - flat.positions[:, :2], axis=1)
    moved = travel > MOVED
    error = np.linalg.norm(final.positions[moved, :2] - ideal.positions[moved, :2], axis=1)
    mean_mm = 1000.0 * float(error.mean()) if moved.any() else math.nan
    return Fidelity(iou(final_mask, ideal.mask), mean_mm, int(moved.sum()), reference)


def _flat_stack(flat: SimState, mesh: Mesh) -> _Stack:
    """One sheet for each panel."""
    points = flat.camera.to_pixels(flat.positions[:, :2])
    pieces = solid_parts(points[mesh.boundary])
    sheets = [_Sheet(tuple(Facet.flat(piece, layer=layer) for piece in pieces), layer) for layer in range(mesh.layers)]
    return _Stack(sheets, points, mesh.layer.astype(int))


def _folded(stack: _Stack, line: FoldLine) -> _Stack:
    """One fold: sheets are cut by the line, and what is left of it turns over and comes down on the rest."""
    halves = [cut_facets(sheet.facets, line) for sheet in stack.sheets]
    sheets = [_Sheet(remaining, sheet.layer) for sheet, (_, remaining) in zip(stack.sheets, halves, strict=True)]
    goes_to = np.zeros(len(halves), int)
    # The highest layer of the lifted stack comes down first.
    for number in sorted(range(len(halves)), key=lambda number: -stack.sheets[number].layer):
        goes_to[number] = len(sheets)
        sheets.append(_laid_on(sheets, halves[number][0], line, stack.sheets[number].layer))
    lifted = line.lifts(stack.points)
    sheet_of = np.where(lifted, goes_to[stack.sheet_of], stack.sheet_of)
    return _Stack(sheets, line.fold(stack.points), sheet_of)


def _laid_on(below: Sequence[_Sheet], lifted: Iterable[Facet], line: FoldLine, layer: int) -> _Sheet:
    """What was lifted from a layer, turned over, in the lowest layer above everything that it lies on."""
    turned = _Sheet(tuple(facet.turned_over(line, layer) for facet in lifted), layer)
    if not turned.facets:
        return turned
    under = [sheet.layer for sheet in below if overlap_area(sheet.shapes, turned.shapes) > TOUCHING]
    return _Sheet(turned.facets, max(under, default=-1) + 1)


def _as_seen(stack: _Stack, flat: SimState, thickness: float) -> IdealFold:
    camera, floor = flat.camera, float(flat.positions[:, 2].min())
    layer = np.array([sheet.layer for sheet in stack.sheets])[stack.sheet_of]
    positions = camera.to_world(stack.points)
    positions[:, 2] = floor + thickness * layer
    area = covered_area(shape for sheet in stack.sheets for shape in sheet.shapes)
    mask, heights = _seen(stack.sheets, camera, floor, thickness)
    return IdealFold(positions, layer, mask, (camera.elevation - heights).astype(np.float32), area)


def _seen(
    sheets: Iterable[_Sheet], camera: Camera, floor: float, thickness: float
) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
    """All sheets at the height of their layer, as the camera sees them: where cloth is, and how high [m]."""
    mask, heights = np.zeros((camera.height, camera.width), bool), np.zeros((camera.height, camera.width), np.float32)
    for sheet in sheets:
        height = floor + thickness * sheet.layer
        for facet in sheet.facets:
            world = camera.to_world(facet.polygon)
            world[:, 2] = height
            covered = fill_polygon(camera.to_pixels(world), camera.height, camera.width)
            mask |= covered
            np.maximum(heights, np.float32(height), out=heights, where=covered)
    return mask, heights
