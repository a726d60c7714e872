"""The picture from straight above that a camera at an angle would have taken, and back from it to the robot's world."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ConfigError, RobotError
from polyfold.geometry import Camera
from polyfold.plugins.hardware import RgbdFrame
from polyfold.types import Observation
from polyfold_pybullet.calibrating import camera_pose
from polyfold_pybullet.looking import Eye

Floats = NDArray[np.float64]

SEEN = 0.98
"""Share of the view that a camera must see."""
STEEPEST = 30.0
"""How far a camera may be turned from straight down [deg]: from farther off a stack of cloth hides what is beside."""
LOOKS = 3
"""How often a view is looked up again where cloth is high: each is nearer to where the ray from above meets it."""


def read_eye(path: Path) -> tuple[Eye, tuple[int, int] | None]:
    """Where a camera really is, from a file of ``polyfold calibrate``, and the size of its pictures, (width, height).

    Raises:
        ConfigError: if it is none.
    """
    advice = "calibrate the camera with 'polyfold calibrate' and name the camera.json that it writes"
    try:
        told: Any = json.loads(path.read_text(encoding="utf-8"))
        eye = Eye(np.array(told["intrinsics"], float), camera_pose(told["pose"], str(path)))
        size = told.get("size")
    except OSError as error:
        raise ConfigError(f"{path} can't be read ({error.strerror}); {advice}") from error
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise ConfigError(f"{path} is no calibration ({error}); {advice}") from error
    focal = eye.intrinsics[[0, 1], [0, 1]] if eye.intrinsics.shape == (3, 3) else np.zeros(2)
    if not np.isfinite(eye.intrinsics).all() or (focal <= 0).any():
        raise ConfigError(f"{path} is no calibration, its intrinsics are no pinhole matrix; {advice}")
    return eye, None if size is None else (int(size[0]), int(size[1]))


@dataclass(frozen=True, eq=False)
class Overhead:
    """A view of the table from straight above.

    Attributes:
        camera: the pinhole that it is as seen by; its world is the robot's, moved and turned.
        centre: the point of the robot's world below it [m], shape (2,).
        turn: how far the picture's right is turned from the world's x, towards its y [rad].
    """

    camera: Camera
    centre: tuple[float, float]
    turn: float

    def observe(self, frame: RgbdFrame, eye: Eye | None = None) -> Observation:
        """What was measured, as seen from above.

        Args:
            frame: the measurement.
            eye: where the camera is, if that is known better than the frame says.

        Raises:
            RobotError: if the camera doesn't see the whole view.
        """
        import cv2

        eye = eye or Eye(frame.intrinsics, frame.extrinsics)
        if not np.isfinite(eye.pose).all():
            raise RobotError(
                "the camera does not know where it is; calibrate it with 'polyfold calibrate', and name camera.json as "
                "the cell's calibration"
            )
        off = float(np.degrees(np.arccos(np.clip(-eye.pose[2, 2], -1.0, 1.0))))
        if off > STEEPEST:
            raise RobotError(
                f"the camera looks {off:.0f} degrees off straight down, {STEEPEST:.0f} are the most; hang it higher, "
                "or calibrate it anew"
            )
        flat = np.zeros((self.camera.height, self.camera.width), np.float32)
        columns, rows = self._seen_at(flat, eye)
        height, width = frame.depth.shape
        inside = ((columns >= 0) & (rows >= 0) & (columns <= width - 1) & (rows <= height - 1)).mean()
        if inside < SEEN:
            raise RobotError(
                f"the camera sees {100 * inside:.1f} % of the view; move the view (centre, extent), or the camera"
            )
        above = self._measured(frame.depth, columns, rows, eye)
        for _ in range(LOOKS):  # where cloth is high, the ray from above meets it elsewhere than at the table
            columns, rows = self._seen_at(np.where(np.isfinite(above), above, np.float32(0.0)), eye)
            above = self._measured(frame.depth, columns, rows, eye)
        rgb = cv2.remap(frame.rgb, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return Observation(np.asarray(rgb, np.uint8), (self.camera.elevation - above).astype(np.float32), self.camera)

    def places(self, pixels: ArrayLike, heights: ArrayLike) -> Floats:
        """Points of the robot's world [m], shape (N, 3), at pixels, shape (N, 2), and heights above the table, (N,)."""
        return self._in_the_robots_world(self.camera.to_world(pixels, heights))

    def _in_the_robots_world(self, points: Floats) -> Floats:
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        x, y, z = np.moveaxis(points, -1, 0)
        return np.stack([cosine * x - sine * y + self.centre[0], sine * x + cosine * y + self.centre[1], z], axis=-1)

    def _seen_at(self, heights: NDArray[np.float32], eye: Eye) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Columns and rows [px] at which the camera sees what lies so high; NaN for what lies behind it."""
        rows, columns = np.indices(heights.shape)
        points = self._in_the_robots_world(self.camera.to_world(np.stack([columns, rows], axis=-1), heights))
        there = np.linalg.inv(eye.pose)
        seen = (points @ there[:3, :3].T + there[:3, 3]) @ eye.intrinsics.T
        depth = np.where(seen[..., 2] > 1e-6, seen[..., 2], np.nan)
        where = seen[..., :2] / depth[..., None]
        return where[..., 0].astype(np.float32), where[..., 1].astype(np.float32)

    def _measured(
        self, image: NDArray[np.float32], columns: NDArray[np.float32], rows: NDArray[np.float32], eye: Eye
    ) -> NDArray[np.float32]:
        """Heights above the table [m] of what is measured at pixels of the camera; NaN where nothing is."""
        import cv2

        depth = cv2.remap(image, columns, rows, cv2.INTER_NEAREST, borderValue=float("nan"))
        inverse = np.linalg.inv(eye.intrinsics).T
        # A pixel's ray and not the view's own: depth is of the pixel that is nearest.
        pixels = np.stack([np.rint(columns), np.rint(rows), np.ones_like(columns)], axis=-1)
        rays = pixels @ inverse
        risen = (rays * depth[..., None]) @ eye.pose[2, :3] + eye.pose[2, 3]
        return risen.astype(np.float32)
