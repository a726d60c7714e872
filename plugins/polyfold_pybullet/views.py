"""Views of a ChArUco board in a hand, as the cell's camera would take them, and what calibration makes of them."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold.geometry import Calibration, Camera
from polyfold_pybullet.looking import Eye

Floats = NDArray[np.float64]

SQUARES, SIDE, MARKER = (7, 5), 0.03, 0.022
"""The board: squares across and down, sides of a square and of its marker [m]."""
BOARD = f"charuco:{SQUARES[0]}x{SQUARES[1]}:{1000 * SIDE:g}:{1000 * MARKER:g}"
IN_HAND = 0.13
"""How far from the fingertips the board's middle is [m]."""
SENSOR, FOCAL = (1280, 720), 910.0
"""Size of the colour picture and its focal length, as of a D435i [px]."""
ACCURACY = 0.001, 0.003
"""How well an arm knows where its tool is: standard deviations of pose, as of arms without a calibration of their own
[m], [rad]."""
BLUR, GRAIN = 0.6, 3.0
"""Of the pictures: [px], [grey levels]."""


@lru_cache(maxsize=64)
def calibrated_eye(camera: Camera, views: int, seed: int) -> Eye:
    """The eye that calibration with so many views takes the camera for; with none the camera itself.

    Pictures for folding are cut from the sensor's and scaled, so that only the pose is not known exactly.
    """
    true = Eye.true(camera)
    if views == 0:
        return true
    pictures, tools = synthetic_views(true.pose, views, seed)
    return Eye(true.intrinsics, Calibration.of(pictures, tools, BOARD, intrinsics=sensor()).pose)


def sensor() -> Floats:
    """Pinhole matrix of the colour sensor [px], shape (3, 3)."""
    width, height = SENSOR
    return np.array([[FOCAL, 0.0, (width - 1) / 2], [0.0, FOCAL, (height - 1) / 2], [0.0, 0.0, 1.0]])


def write_views(folder: Path, count: int, seed: int) -> None:
    """Write views of the cell's camera, 0.9 m over the table, and the poses that go with them into a folder.

    Raises:
        ConfigError: if there is anything in it, so that nothing is overwritten.
    """
    import cv2

    if count < Calibration.fewest:
        raise ConfigError(f"calibration needs {Calibration.fewest} views and more, not {count}; 20 are good")
    folder.mkdir(parents=True, exist_ok=True)
    if any(folder.iterdir()):
        raise ConfigError(f"{folder} is not empty; give a new folder for simulated views")
    pictures, tools = synthetic_views(Eye.true(Camera(elevation=0.9)).pose, count, seed)
    poses = {}
    for number, (picture, tool) in enumerate(zip(pictures, tools, strict=True)):
        name = f"view-{number:02}.png"
        (folder / name).write_bytes(cv2.imencode(".png", picture[:, :, ::-1])[1].tobytes())
        poses[name] = tool.round(6).tolist()
    (folder / "poses.json").write_text(json.dumps(poses, indent=1) + "\n", encoding="utf-8")


def synthetic_views(pose: Floats, count: int, seed: int) -> tuple[list[NDArray[np.uint8]], Floats]:
    """Pictures of a board that a hand shows to a camera over the table, and the poses that the arm tells.

    Args:
        pose: of the camera in the world, shape (4, 4).
        count: how many.
        seed: of the hand's poses and of all errors.

    Returns:
        Pictures, uint8, shape (H, W, 3) each, and poses of the tool, shape (count, 4, 4).
    """
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(seed)
    facing_up = np.eye(4)
    facing_up[:3, 3] = [-SQUARES[0] * SIDE / 2, -SQUARES[1] * SIDE / 2, 0.0]
    held = np.eye(4)  # between the fingers, which close along its normal, and beyond their tips
    held[:3, :3] = Rotation.from_euler("x", np.pi / 2).as_matrix()
    held[:3, 3] = [0.0, 0.0, IN_HAND]
    board_in_tool = held @ facing_up
    pictures, tools = [], []
    for _ in range(count):
        # Facing the camera, turned about its axis, tilted.
        board = np.eye(4)
        turn = Rotation.from_euler("zyx", [rng.uniform(-np.pi, np.pi), *np.deg2rad(rng.uniform(-30, 30, 2))])
        board[:3, :3] = pose[:3, :3] @ turn.as_matrix()
        board[:3, 3] = [*rng.uniform([-0.25, -0.2], [0.25, 0.2]), rng.uniform(0.05, 0.35)]
        tool = board @ np.linalg.inv(held)
        pictures.append(_picture(np.linalg.inv(pose) @ tool @ board_in_tool, rng))
        error = np.eye(4)
        error[:3, :3] = Rotation.from_rotvec(rng.normal(0, ACCURACY[1], 3)).as_matrix()
        error[:3, 3] = rng.normal(0, ACCURACY[0], 3)
        tools.append(tool @ error)
    return pictures, np.array(tools)


def _picture(board: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """A picture of a board at a pose in the camera's frame, shape (4, 4)."""
    import cv2

    fine = 20 / SIDE * 2  # pixels a metre of the drawn board
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    drawn = cv2.aruco.CharucoBoard(SQUARES, SIDE, MARKER, family).generateImage(
        (round(SQUARES[0] * SIDE * fine), round(SQUARES[1] * SIDE * fine))
    )
    # Pixel centres of the drawn board in metres, then into the picture.
    metres = np.array([[1 / fine, 0.0, 0.5 / fine], [0.0, 1 / fine, 0.5 / fine], [0.0, 0.0, 1.0]])
    seen = sensor() @ np.column_stack([board[:3, 0], board[:3, 1], board[:3, 3]]) @ metres
    width, height = SENSOR
    grey = cv2.warpPerspective(drawn, seen, (width, height), flags=cv2.INTER_AREA, borderValue=200)
    grey = cv2.GaussianBlur(grey, (0, 0), BLUR).astype(float) + rng.normal(0, GRAIN, (height, width))
    return np.repeat(np.clip(grey, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
