"""From pixels and measured depth to places of the cell, through a camera that is not quite where it seems."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GroundingError
from polyfold.geometry import Camera

Floats = NDArray[np.float64]

AROUND = (3, 6, 12)
"""Depth is the median of pixels so far around [px]; of those farther off where too few of the nearer were measured."""
SEEN = 0.3
"""Share of those pixels that must have been measured."""
LOWEST, HIGHEST = -0.02, 0.15
"""What lies lower or higher than this above the table is no cloth but an error, or an arm in view [m]."""


@dataclass(frozen=True, eq=False)
class Eye:
    """A calibrated camera over a table.

    Attributes:
        intrinsics: pinhole matrix [px], shape (3, 3).
        pose: of the camera in the world as calibrated, z along the optical axis, y down in the image, shape (4, 4).
    """

    intrinsics: Floats
    pose: Floats

    @classmethod
    def true(cls, camera: Camera) -> Eye:
        """The eye that is exactly where the camera is."""
        intrinsics = np.array(
            [[camera.focal, 0.0, camera.centre[0]], [0.0, camera.focal, camera.centre[1]], [0.0, 0.0, 1.0]]
        )
        pose = np.diag([1.0, -1.0, -1.0, 1.0])
        pose[2, 3] = camera.elevation
        return cls(intrinsics, pose)

    def after_a_push(self, way: float, turn: float, seed: int) -> Eye:
        """Where it is taken to be once the camera was pushed and nobody noticed.

        Args:
            way: how far it was pushed [m].
            turn: by how much it was turned [rad].
            seed: of the directions.
        """
        from scipy.spatial.transform import Rotation

        rng = np.random.default_rng([seed, 11])
        along, about = (axis / np.linalg.norm(axis) for axis in rng.normal(size=(2, 3)))
        off = np.eye(4)
        off[:3, :3], off[:3, 3] = Rotation.from_rotvec(turn * about).as_matrix(), way * along
        return Eye(self.intrinsics, self.pose @ off)

    def places(self, pixels: ArrayLike, depth: ArrayLike) -> Floats:
        """World points [m], shape (N, 3), seen at pixels, shape (N, 2), at distances along the optical axis, (N,)."""
        pixels = np.asarray(pixels, float)
        rays = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(self.intrinsics).T
        return (rays * np.asarray(depth, float)[:, None]) @ self.pose[:3, :3].T + self.pose[:3, 3]


def levelled(eye: Eye, surface: Surface, noticed: float) -> tuple[Eye, float]:
    """The eye turned so that the table it sees is level and at z = 0, if it is off by more than ``noticed`` [rad].

    A table says how a camera is tilted and how high it hangs; where it hangs, and how it is turned about the vertical,
    it does not.

    Returns:
        The eye, and by how much it was tilted [rad]; the same eye if that is too little to tell from depth's errors.
    """
    from scipy.spatial.transform import Rotation

    height, width = surface.depth.shape
    corners = np.array([[0.0, 0.0], [width - 1.0, 0.0], [0.0, height - 1.0]])
    first, across, down = eye.places(corners, surface.table @ np.column_stack([np.ones(3), corners]).T)
    normal = np.cross(down - first, across - first)
    normal *= np.sign(normal[2]) / np.linalg.norm(normal)
    tilt = float(np.arccos(np.clip(normal[2], -1.0, 1.0)))
    if tilt <= noticed:
        return eye, tilt
    back = Rotation.from_rotvec(tilt * np.array([normal[1], -normal[0], 0.0]) / np.hypot(*normal[:2])).as_matrix()
    pose = eye.pose.copy()
    pose[:3, :3] = back @ eye.pose[:3, :3]
    pose[2, 3] = float(normal @ (eye.pose[:3, 3] - first))
    return Eye(eye.intrinsics, pose), tilt


@dataclass(frozen=True, eq=False)
class Surface:
    """A depth image with the table's plane fitted to it, which takes the plane out of the camera's errors.

    Attributes:
        depth: distance along the optical axis [m], NaN where none was measured, shape (H, W).
        table: what the distance would be of the empty table: offset, and change per column and row, shape (3,).
    """

    depth: NDArray[np.float32]
    table: Floats

    @classmethod
    def of(cls, depth: NDArray[np.float32]) -> Surface:
        """The table is looked for outside the circle that touches the picture's sides, where no garment lies.

        Raises:
            GroundingError: if too little of the table was measured.
        """
        height, width = depth.shape
        rows, columns = np.mgrid[:height, :width]
        outside = np.hypot(columns - (width - 1) / 2, rows - (height - 1) / 2) > min(width, height) / 2
        use = outside & np.isfinite(depth)
        if use.sum() < 0.02 * depth.size:
            raise GroundingError(
                "the depth image hardly shows the table around the cloth; clear the view and look again"
            )
        terms = np.column_stack([np.ones(use.sum()), columns[use], rows[use]])
        measured = depth[use].astype(float)
        table = np.linalg.lstsq(terms, measured, rcond=None)[0]
        for _ in range(2):  # without what lies on the table
            off = np.abs(measured - terms @ table)
            near = off <= 3 * max(1.4826 * float(np.median(off)), 1e-4)
            table = np.linalg.lstsq(terms[near], measured[near], rcond=None)[0]
        return cls(depth, np.asarray(table, float))

    def at(self, pixel: ArrayLike) -> tuple[float, float]:
        """Height above the table [m] around a pixel, and the distance of the table there along the optical axis [m].

        Raises:
            GroundingError: if depth is missing there, or can't be of cloth.
        """
        x, y = np.asarray(pixel, float)
        height, width = self.depth.shape
        column, row = int(np.clip(round(x), 0, width - 1)), int(np.clip(round(y), 0, height - 1))
        windows = (self.depth[max(0, row - r) : row + r + 1, max(0, column - r) : column + r + 1] for r in AROUND)
        window = next((window for window in windows if np.isfinite(window).mean() >= SEEN), None)
        if window is None:
            raise GroundingError(f"there is no depth around the pixel ({x:.0f}, {y:.0f}); look again")
        table = float(self.table @ [1.0, x, y])
        above = table - float(np.nanmedian(window))
        if not LOWEST <= above <= HIGHEST:
            raise GroundingError(
                f"what is seen at the pixel ({x:.0f}, {y:.0f}) is {1000 * above:.0f} mm above the table; "
                "clear the view and look again"
            )
        return above, table
