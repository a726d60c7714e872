"""A coarse copy of the garment in a simulator of one's own, to try actions in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import ActionError, SimulationError
from polyfold.garments import Garment, Mesh, Outline, mesh_panels
from polyfold.geometry import Camera, polygon_area
from polyfold.plugins.interfaces import Simulator
from polyfold.types import Action, SimState

Floats = NDArray[np.float64]

CORNERS_WITHIN = 0.015
"""A corner of the simplified outline is kept where leaving it out would move the outline by more, as a share of it."""


@dataclass(frozen=True, eq=False)
class Copy:
    """The copy, lying as the garment lay, of what such garments usually are made of.

    Attributes:
        simulator: it lies in.
        match: for each of its particles the garment's nearest of the same layer, shape (K,).
        corners: its particles at the corners of the simplified outline, shape (C,).
    """

    simulator: Simulator
    match: NDArray[np.int64]
    corners: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: Mesh, flat: SimState, kind: str, particles: int, simulator: ComponentSpec) -> Copy:
        """Copy a garment.

        Args:
            mesh: of the garment at rest.
            flat: how it lies, flat.
            kind: of garment.
            particles: about how many the copy has.
            simulator: to make for it.
        """
        outline = _outline(mesh)
        area = abs(polygon_area(outline.points)) * mesh.layers
        # A triangle's share of the plane by its edge; there are about twice as many triangles as particles.
        edge = float(np.sqrt(area / particles * 2 / np.sqrt(3)))
        coarse, _ = mesh_panels(outline, mesh.layers, edge)
        match = _nearest(mesh, coarse)
        keypoints = {name: _nearest_of(coarse, mesh.vertices[index]) for name, index in flat.keypoints.items()}
        garment = Garment(
            kind, f"{kind}-copy", None, coarse, keypoints,
            fabric=plugins.make_fabric(Experiment().fabric, kind), angle_deg=_angle(mesh, flat),
        )  # fmt: skip
        made: Simulator = plugins.create("simulators", simulator.name, simulator.params)
        made.reset(garment, 0)
        corners = np.array([_nearest_of(coarse, outline.points[index]) for index in outline.corners.values()])
        return cls(made, match, np.unique(corners))

    def lands(self, before: SimState, action: Action) -> Floats | None:
        """Where its particles lie after an action from a state [m], shape (K, 3); None if it can't be done."""
        self.simulator.restore(before)
        try:
            self.simulator.execute(action)
        except (ActionError, SimulationError):
            return None
        return self.simulator.state().positions


def pixels(camera: Camera, start: Floats, by: Floats) -> tuple[Floats, Floats]:
    """Where a pick [m], shape (3,), and its place, so far from it over the table [m], shape (2,), are in a picture.

    Returns:
        Pick and place [px], shape (1, 2) each; those outside are pulled to its border.
    """
    limit = np.array([camera.width, camera.height]) - 2.0
    pick = camera.to_pixels(start)
    place = camera.to_pixels(np.append(start[:2] + by, 0.0))
    return np.clip(pick, 1.0, limit)[None], np.clip(place, 1.0, limit)[None]


def _outline(mesh: Mesh) -> Outline:
    """The silhouette with the corners of its simplification; open where its seam is."""
    import cv2

    ring = mesh.vertices[mesh.boundary]
    within = CORNERS_WITHIN * float(np.ptp(ring, axis=0).max())
    kept = cv2.approxPolyDP(ring.astype(np.float32)[:, None], within, True)[:, 0]
    index = sorted({int(np.argmin(np.hypot(*(ring - corner).T))) for corner in kept})
    if mesh.layers == 1:
        return Outline(ring, {f"corner{k}": k for k in index})
    sewn = mesh.seam[mesh.boundary]
    ends = {k for k in range(len(ring)) if sewn[k] and not (sewn[k - 1] and sewn[(k + 1) % len(ring)])}
    stops = sorted({*index, *ends})
    corners = {f"corner{k}": k for k in stops}
    openings = tuple(
        (f"corner{first}", f"corner{last}")
        for first, last in zip(stops, [*stops[1:], stops[0]], strict=True)
        if not sewn[(first + 1) % len(ring)] and (first + 1) % len(ring) != last
    )
    return Outline(ring, corners, openings)


def _nearest(mesh: Mesh, coarse: Mesh) -> NDArray[np.int64]:
    from scipy.spatial import KDTree

    match = np.zeros(len(coarse.vertices), np.int64)
    for layer in range(mesh.layers):
        theirs = np.flatnonzero((mesh.layer == layer) | mesh.seam)
        ours = np.flatnonzero(coarse.layer == layer)
        match[ours] = theirs[KDTree(mesh.vertices[theirs]).query(coarse.vertices[ours])[1]]
    return match


def _nearest_of(mesh: Mesh, point: Floats) -> int:
    return int(np.argmin(np.hypot(*(mesh.vertices - point).T)))


def _angle(mesh: Mesh, flat: SimState) -> float:
    """How far the garment lies turned from its rest, counter-clockwise [degrees]."""
    rest, lies = (points[:, :2] - points[:, :2].mean(0) for points in (mesh.vertices, flat.positions))
    along = float((rest * lies).sum())
    across = float((rest[:, 0] * lies[:, 1] - rest[:, 1] * lies[:, 0]).sum())
    return float(np.degrees(np.arctan2(across, along)))
