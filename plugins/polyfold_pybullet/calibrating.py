"""``polyfold calibrate``: where a camera is that looks at a board in an arm's hand."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError

if TYPE_CHECKING:
    from polyfold.geometry import Calibration

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

POSES = "poses.json"
FAR = 5.0
"""No arm on a table reaches so far [m]: its lengths are in other units."""
ABOUT = 50.0
"""How much is drawn around the board [px]."""
EXAMPLE = '{"view-00.png": [[1, 0, 0, 0.3], [0, 1, 0, 0.1], [0, 0, 1, 0.25], [0, 0, 0, 1]], ...}'


class Calibrate:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        from polyfold_pybullet.views import BOARD

        parser.add_argument(
            "folder",
            type=Path,
            help=f"pictures of the board, and {POSES}: the tool's pose in the robot's world by file name, 4 by 4 [m]",
        )
        parser.add_argument(
            "--board",
            default=BOARD,
            metavar="charuco:COLUMNSxROWS:SQUARE:MARKER",
            help=f"the board, sides in mm (default: {BOARD})",
        )
        parser.add_argument(
            "--intrinsics",
            metavar="FX,FY,CX,CY",
            help="focal lengths and principal point of the pictures [px] (default: found from the views)",
        )
        parser.add_argument("--out", type=Path, metavar="JSON", help="default: camera.json in the folder")
        parser.add_argument(
            "--simulate",
            type="count",
            metavar="N",
            help="first fill the folder, new or empty, with so many views of the simulated cell",
        )
        parser.add_argument("--seed", type="seed", default=0, metavar="N", help="of the simulated views (default: 0)")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Calibrate, write the result and a picture of it, and say how good it is."""
        from polyfold.geometry import Calibration
        from polyfold_pybullet.views import write_views

        intrinsics = None if arguments.intrinsics is None else _matrix(arguments.intrinsics)
        out = arguments.out or arguments.folder / "camera.json"
        if out.suffix != ".json" or out.name == POSES:
            raise ConfigError(f"--out {out} is not a name for the result; give one that ends in .json, not {POSES}")
        if arguments.simulate:
            write_views(arguments.folder, arguments.simulate, arguments.seed)
        names, pictures, tools = read_views(arguments.folder)
        if out.with_suffix(".png").resolve() in {(arguments.folder / name).resolve() for name in names}:
            raise ConfigError(
                f"the picture beside {out} would take the place of one of the board; choose another --out"
            )
        found = Calibration.of(pictures, tools, arguments.board, intrinsics)
        out.parent.mkdir(parents=True, exist_ok=True)
        height, width = pictures[0].shape[:2]
        told = {"size": [width, height], **_told(found, names, arguments.board)}
        out.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        picture = out.with_suffix(".png")
        _draw(found, names, pictures, picture)
        used = len(found.corners) - sum(number in found.corners for number in found.skipped)
        print(f"{used} of {len(names)} views used; corners are {found.error:.2f} px from where they should be (RMS)")
        for number, why in found.skipped.items():
            print(f"  left out {names[number]}: {why}")
        x, y, z = found.pose[:3, 3]
        print(f"camera at ({x:.4f}, {y:.4f}, {z:.4f}) m in the robot's world: {out}")
        print(f"picture: {picture}")
        return 0


def read_views(folder: Path) -> tuple[list[str], list[Picture], Floats]:
    """Names, pictures (uint8, RGB) and poses of the tool, shape (N, 4, 4), of a folder.

    Raises:
        ConfigError: if a file is missing, is no picture, or a pose is none.
    """
    path = folder / POSES
    if not path.is_file():
        raise ConfigError(f"{folder} holds no {POSES}; write into it, for every picture, {EXAMPLE}")
    try:
        poses = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{path} is no JSON ({error}); write {EXAMPLE}") from error
    if not isinstance(poses, dict) or not poses:
        raise ConfigError(f"{path} names no pictures; write {EXAMPLE}")
    names = sorted(poses)
    pictures = [_picture(folder / name) for name in names]
    if len({picture.shape for picture in pictures}) > 1:
        raise ConfigError(f"the pictures in {folder} differ in size; give those of one camera at one resolution")
    return names, pictures, np.array([camera_pose(poses[name], f"{path}, {name}") for name in names])


def _picture(path: Path) -> Picture:
    import cv2

    content = np.frombuffer(path.read_bytes(), np.uint8) if path.is_file() else None
    if content is None:
        raise ConfigError(f"there is no picture {path}, which {POSES} names")
    read = cv2.imdecode(content, cv2.IMREAD_COLOR) if len(content) else None
    if read is None:
        raise ConfigError(f"{path} is no picture that can be read; give PNG or JPEG")
    return cv2.cvtColor(read, cv2.COLOR_BGR2RGB).astype(np.uint8)


def camera_pose(given: Any, where: str) -> Floats:
    """A pose, shape (4, 4), as a file has it. Raises ConfigError, which begins with ``where``, if it is none."""
    try:
        pose = np.array(given, float)
    except (TypeError, ValueError):
        pose = np.empty(0)
    if pose.shape != (4, 4) or not np.isfinite(pose).all() or not np.allclose(pose[3], [0, 0, 0, 1]):
        raise ConfigError(f"{where}: a pose is four rows of four numbers, the last 0 0 0 1")
    turn = pose[:3, :3]
    if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) or np.linalg.det(turn) < 0:
        raise ConfigError(f"{where}: the first three columns are no rotation; give a right-handed one")
    if np.abs(pose[:3, 3]).max() > FAR:
        raise ConfigError(f"{where}: the tool would be {np.abs(pose[:3, 3]).max():.0f} m away; give metres")
    return pose


def _matrix(text: str) -> Floats:
    try:
        across, down, x, y = (float(part) for part in text.split(","))
    except ValueError:
        across = down = x = y = -1.0
    if not (np.isfinite([across, down, x, y]).all() and across > 0 and down > 0 and x > 0 and y > 0):
        raise ConfigError(f"--intrinsics {text!r} is not FX,FY,CX,CY in pixels; for example 910,910,639.5,359.5")
    return np.array([[across, 0.0, x], [0.0, down, y], [0.0, 0.0, 1.0]])


def _told(found: Calibration, names: list[str], board: str) -> dict[str, Any]:
    return {
        "intrinsics": found.intrinsics.round(4).tolist(),
        "pose": found.pose.round(8).tolist(),
        "board": board,
        "board_in_tool": found.board.round(8).tolist(),
        "error_px": round(found.error, 4),
        "errors_px": {names[number]: round(error, 4) for number, error in found.errors.items()},
        "left_out": {names[number]: why for number, why in found.skipped.items()},
    }


def _draw(found: Calibration, names: list[str], pictures: list[Picture], path: Path) -> None:
    """Every view with the corners that are seen and where they should be, ten times as far off as they are."""
    from matplotlib.figure import Figure

    columns = min(5, len(pictures))
    rows = -(-len(pictures) // columns)
    figure = Figure((2.6 * columns, 2.2 * rows + 0.4), layout="constrained")
    figure.suptitle("corners as seen (green), and ten times how far they are from where they should be", fontsize=9)
    for number, (picture, name) in enumerate(zip(pictures, names, strict=True)):
        axes = figure.add_subplot(rows, columns, number + 1)
        axes.imshow(picture)
        axes.set_axis_off()
        error = found.errors.get(number)
        title = f"{name}: " + ("not seen" if error is None else f"{error:.2f} px")
        axes.set_title(title, fontsize=7, color="firebrick" if number in found.skipped else "black")
        if number in found.corners:
            seen, due = found.corners[number]
            axes.plot(*seen.T, ".", color="seagreen", markersize=3)
            (left, top), (right, bottom) = seen.min(axis=0) - ABOUT, seen.max(axis=0) + ABOUT
            axes.set(xlim=(left, right), ylim=(bottom, top))
            axes.quiver(*seen.T, *(10 * (due - seen)).T, angles="xy", scale_units="xy", scale=1, color="darkorange")
    figure.savefig(path, dpi=110)
