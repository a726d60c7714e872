"""Where a camera is: from pictures of a ChArUco board that an arm holds in known poses (eye to hand)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.geometry._charuco import described, find_board

Floats = NDArray[np.float64]

OUTLIER = 3.0
"""A view whose error is so many times the median's is left out ..."""
GOOD = 0.5
"""... unless it is as small as this [px]."""


WORST = 0.01
"""Corners farther from where they should be than this share of the picture's longer side fit no camera."""
TURN = 0.1
"""The hand must have turned by so much between two views at least [rad]."""
ADVICE = (
    "check the board's sides and the intrinsics, that poses are in metres and of the tool in the robot's world, and "
    "that each belongs to its picture"
)


@dataclass(frozen=True, eq=False)
class _View:
    """A picture that shows the board: its number, the tool's pose, corners on the board [m] and where they are [px]."""

    number: int
    tool: Floats
    places: NDArray[np.float32]
    pixels: NDArray[np.float32]

    def due(self, camera: Floats, held: Floats, intrinsics: Floats) -> Floats:
        """Where the corners should be [px], shape (N, 2), by the poses of the camera and of the board in the tool."""
        whole = np.linalg.inv(camera) @ self.tool @ held
        seen = (self.places @ whole[:3, :3].T + whole[:3, 3]) @ intrinsics.T
        return seen[:, :2] / seen[:, 2:]


@dataclass(frozen=True, eq=False)
class Calibration:
    """A calibrated camera.

    Attributes:
        intrinsics: pinhole matrix [px], shape (3, 3).
        pose: of the camera in the robot's world, z along the optical axis, y down in the image, shape (4, 4).
        board: pose of the board in the tool that holds it, shape (4, 4).
        corners: where corners of the board were seen and where they should be [px], shape (N, 2) each, by the number of
            the view from 0, of all views that show the board.
        skipped: what was wrong with each view that was not used, by its number from 0.
        fewest: views of the board that are needed; 15 to 20 that differ in tilt are good.
    """

    fewest: ClassVar[int] = 5

    intrinsics: Floats
    pose: Floats
    board: Floats
    corners: Mapping[int, tuple[Floats, Floats]]
    skipped: Mapping[int, str]

    @classmethod
    def of(
        cls,
        pictures: Sequence[NDArray[np.uint8]],
        tools: ArrayLike,
        board: str,
        intrinsics: ArrayLike | None = None,
    ) -> Calibration:
        """Calibrate a camera that looks at a board held by an arm.

        A closed-form start (Park and Martin 1994, 10.1109/70.326576) is refined until the corners' reprojection error
        is least, over the poses of camera and board together.

        Args:
            pictures: uint8, shape (H, W, 3) each.
            tools: pose of the tool in the robot's world when each was taken, shape (N, 4, 4).
            board: ``charuco:COLUMNSxROWS:SQUARE:MARKER[:DICTIONARY]``, sides in millimetres.
            intrinsics: pinhole matrix [px], shape (3, 3); estimated from the views without it, which needs tilted ones.

        Raises:
            GarmentError: if the board is seen in too few of them, the hand hardly turned between them, or no pose of
                the camera explains them.
        """
        views, skipped = _seen(pictures, _checked(tools, len(pictures)), board)
        matrix = _intrinsics(views, pictures[0].shape[:2]) if intrinsics is None else np.asarray(intrinsics, float)
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
            raise GarmentError("intrinsics are a finite pinhole matrix of shape (3, 3) in pixels")
        camera, held = _solved(views, matrix)
        if wrong := _wrong(views, camera, held, matrix):
            camera, held = _solved([view for view in views if view.number not in wrong], matrix)
            wrong = _wrong(views, camera, held, matrix)
        skipped |= {
            number: f"corners are {error:.1f} px from where they should be; was the arm at rest, and is the pose right?"
            for number, error in wrong.items()
        }
        corners = {view.number: (view.pixels.astype(float), view.due(camera, held, matrix)) for view in views}
        found = cls(matrix, camera, held, corners, dict(sorted(skipped.items())))
        if not found.error <= WORST * max(pictures[0].shape[:2]):
            raise GarmentError(f"corners are {found.error:.0f} px from where they should be at best; {ADVICE}")
        return found

    @staticmethod
    def corners_seen(picture: NDArray[np.uint8], board: str) -> int:
        """How many corners of a board can be told in a picture, uint8, shape (H, W, 3); 0 if too few for a view.

        Raises:
            GarmentError: if the board's description can't be read.
        """
        described(board)
        try:
            return len(find_board(picture, board)[0])
        except GarmentError:
            return 0

    @property
    def errors(self) -> dict[int, float]:
        """Root mean square distance of corners from where they should be [px], by the number of the view."""
        return {number: _rms(seen - due) for number, (seen, due) in self.corners.items()}

    @property
    def error(self) -> float:
        """The same of all views that were used [px]."""
        used = [error for number, error in self.errors.items() if number not in self.skipped]
        return float(np.sqrt(np.mean(np.square(used))))


def _checked(tools: ArrayLike, count: int) -> Floats:
    """Poses of the tool, shape (count, 4, 4). Raises GarmentError if they are none."""
    poses = np.asarray(tools, float)
    if len(poses) != count:
        raise GarmentError(f"there are {count} pictures and {len(poses)} poses; give one pose for each")
    if poses.shape != (count, 4, 4) or not np.isfinite(poses).all():
        raise GarmentError(f"poses of the tool are finite and of shape ({count}, 4, 4), not {poses.shape}")
    turns = poses[:, :3, :3]
    if not np.allclose(turns @ turns.transpose(0, 2, 1), np.eye(3), atol=1e-2) or (np.linalg.det(turns) < 0).any():
        raise GarmentError(
            "a pose of the tool holds no rotation in its first three rows and columns; give metres and turns"
        )
    return poses


def _seen(pictures: Sequence[NDArray[np.uint8]], tools: Floats, board: str) -> tuple[list[_View], dict[int, str]]:
    """The pictures that show the board, and why the others do not, by their numbers."""
    described(board)
    views: list[_View] = []
    skipped: dict[int, str] = {}
    for number, (picture, tool) in enumerate(zip(pictures, tools, strict=True)):
        if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3:
            raise GarmentError(f"picture {number} has {picture.dtype} and shape {picture.shape}; give uint8, (H, W, 3)")
        try:
            pixels, places, _ = find_board(picture, board)
        except GarmentError as error:
            skipped[number] = str(error)
        else:
            deep = np.column_stack([places, np.zeros(len(places))])
            views.append(_View(number, tool, deep.astype(np.float32), pixels.astype(np.float32)))
    if len(views) < Calibration.fewest:
        first = f"; the first that is not: {next(iter(skipped.values()))}" if skipped else ""
        raise GarmentError(
            f"the board is seen in {len(views)} of {len(pictures)} pictures, {Calibration.fewest} are needed{first}"
        )
    turns = [np.arccos(np.clip((np.trace(views[0].tool[:3, :3].T @ v.tool[:3, :3]) - 1) / 2, -1, 1)) for v in views]
    if max(turns) < TURN:
        raise GarmentError("the hand hardly turned between the views; tilt the board by 20 degrees and more both ways")
    return views, skipped


def _intrinsics(views: Sequence[_View], size: tuple[int, ...]) -> Floats:
    """Pinhole matrix, shape (3, 3), of pictures of ``size``, (height, width) [px]; a lens without distortion."""
    import cv2

    flags = cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3
    points, pixels = [view.places for view in views], [view.pixels for view in views]
    # The overloads of OpenCV's stubs know no call without a start.
    calibrated: Any = cv2.calibrateCamera
    return np.asarray(calibrated(points, pixels, (size[1], size[0]), None, None, flags=flags)[1], float)


def _solved(views: Sequence[_View], intrinsics: Floats) -> tuple[Floats, Floats]:
    """Pose of the camera in the world, and of the board in the tool."""
    import cv2

    try:
        return _refined(*_closed_form(views, intrinsics), intrinsics, views)
    except (ValueError, np.linalg.LinAlgError, cv2.error) as error:
        raise GarmentError(f"no pose of a camera explains the views; {ADVICE}") from error


def _wrong(views: Sequence[_View], camera: Floats, held: Floats, intrinsics: Floats) -> dict[int, float]:
    """The errors [px] of views that are much worse than the others, by their numbers."""
    errors = {view.number: _rms(view.pixels - view.due(camera, held, intrinsics)) for view in views}
    limit = max(OUTLIER * float(np.median(list(errors.values()))), GOOD)
    return {number: error for number, error in errors.items() if error > limit}


def _closed_form(views: Sequence[_View], intrinsics: Floats) -> tuple[Floats, Floats]:
    """Pose of the camera in the world, and of the board in the tool."""
    import cv2

    boards = []
    for view in views:
        _, turn, shift = cv2.solvePnP(view.places, view.pixels, intrinsics, np.zeros(5), flags=cv2.SOLVEPNP_IPPE)
        boards.append(_matrix(np.concatenate([turn.ravel(), shift.ravel()]).astype(float)))
    inverse = [np.linalg.inv(view.tool) for view in views]
    turn, shift = cv2.calibrateHandEye(
        [pose[:3, :3] for pose in inverse], [pose[:3, 3] for pose in inverse],
        [board[:3, :3] for board in boards], [board[:3, 3] for board in boards], method=cv2.CALIB_HAND_EYE_PARK,
    )  # fmt: skip
    camera = np.eye(4)
    camera[:3, :3], camera[:3, 3] = turn, shift.ravel()
    return camera, inverse[0] @ camera @ boards[0]


def _refined(camera: Floats, held: Floats, intrinsics: Floats, views: Sequence[_View]) -> tuple[Floats, Floats]:
    """Poses of camera and board for which corners are seen nearest to where they should be."""
    from scipy.optimize import least_squares

    def residuals(values: Floats) -> Floats:
        poses = _matrix(values[:6]), _matrix(values[6:])
        return np.concatenate([(view.due(*poses, intrinsics) - view.pixels).ravel() for view in views])

    found = least_squares(residuals, np.concatenate([_vector(camera), _vector(held)]), loss="soft_l1")
    return _matrix(found.x[:6]), _matrix(found.x[6:])


def _rms(off: Floats) -> float:
    return float(np.sqrt((off**2).sum(axis=1).mean()))


def _matrix(values: Floats) -> Floats:
    """A pose, shape (4, 4), from a rotation vector [rad] and a position [m], shape (6,)."""
    from scipy.spatial.transform import Rotation

    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Rotation.from_rotvec(values[:3]).as_matrix(), values[3:]
    return pose


def _vector(pose: Floats) -> Floats:
    from scipy.spatial.transform import Rotation

    return np.concatenate([Rotation.from_matrix(pose[:3, :3]).as_rotvec(), pose[:3, 3]])
