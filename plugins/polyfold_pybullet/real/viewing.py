"""A folder of views for ``polyfold calibrate``, filled one by one from a camera and an arm."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold.geometry import Calibration
from polyfold.plugins.hardware import RgbdFrame
from polyfold_pybullet.calibrating import POSES, read_views

Floats = NDArray[np.float64]


class Views:
    """Pictures of a board and the poses of the tool that held it; each is on the disk once it is taken."""

    def __init__(self, folder: Path, board: str, poses: dict[str, list[list[float]]]) -> None:
        self._folder, self._board, self._poses = folder, board, poses

    @classmethod
    def of(cls, folder: Path, board: str) -> Views:
        """Go on in a folder, or begin a new one.

        Raises:
            ConfigError: if it holds something else, or views that can't be read.
            GarmentError: if the board's description can't be read.
        """
        Calibration.corners_seen(np.zeros((8, 8, 3), np.uint8), board)
        if (folder / POSES).is_file():
            names, _, tools = read_views(folder)
            return cls(folder, board, dict(zip(names, tools.tolist(), strict=True)))
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise ConfigError(f"{folder} holds something else than views; give a new folder")
        return cls(folder, board, {})

    def __len__(self) -> int:
        return len(self._poses)

    def take(self, frame: RgbdFrame, tool: Floats) -> str:
        """Keep one view, if the board is seen in it.

        Args:
            frame: the measurement.
            tool: the tool's pose meanwhile, shape (4, 4).

        Returns:
            What became of it, in words.
        """
        import cv2

        corners = Calibration.corners_seen(frame.rgb, self._board)
        if not corners:
            return "not kept: the board is not seen; show all of it, larger and sharp"
        name = self._free_name()
        self._folder.mkdir(parents=True, exist_ok=True)
        (self._folder / name).write_bytes(cv2.imencode(".png", frame.rgb[:, :, ::-1])[1].tobytes())
        self._poses[name] = np.asarray(tool, float).round(6).tolist()
        part = self._folder / f"{POSES}.part"
        part.write_text(json.dumps(self._poses, indent=1) + "\n", encoding="utf-8")
        part.replace(self._folder / POSES)
        return f"{name}: {corners} corners of the board"

    def _free_name(self) -> str:
        number = len(self._poses)
        while (name := f"view-{number:02}.png") in self._poses or (self._folder / name).exists():
            number += 1
        return name
