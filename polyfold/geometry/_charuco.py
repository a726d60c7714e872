"""ChArUco boards in photographs."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError, did_you_mean
from polyfold.geometry._homography import homography, mapped

Floats = NDArray[np.float64]

DESCRIPTION = re.compile(r"charuco:(\d+)x(\d+):([\d.]+):([\d.]+)(?::(\w+))?", re.IGNORECASE)

FEWEST = 6
"""Corners of the board that must be seen."""


def find_board(rgb: NDArray[np.uint8], description: str) -> tuple[Floats, Floats, Floats]:
    """The corners of a board's squares in a photograph.

    Args:
        rgb: the photograph, uint8, shape (H, W, 3).
        description: ``charuco:COLUMNSxROWS:SQUARE:MARKER[:DICTIONARY]``, sides in millimetres.

    Returns:
        Corners [px], their places on the board [m], each of shape (N, 2), and the board's own four corners [px].

    Raises:
        GarmentError: if too few are seen, or the description can't be read.
    """
    import cv2

    board, (across, down) = described(description)
    corners, numbers, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY))
    count = 0 if numbers is None else len(numbers)
    if count < FEWEST:
        raise GarmentError(
            f"of the board {description} {count} corners are seen, at least {FEWEST} are needed; show more of it, "
            "larger and sharp, or check its description"
        )
    everywhere = np.array(board.getChessboardCorners(), float)
    places = everywhere[np.asarray(numbers, int).ravel(), :2]
    pixels = np.asarray(corners, float).reshape(-1, 2)
    if np.linalg.svd(places - places.mean(axis=0))[1][-1] < 1e-6:
        raise GarmentError(f"the corners of {description} that are seen lie in one row; show more of the board")
    around = np.array([[0.0, 0.0], [across, 0.0], [across, down], [0.0, down]])
    return pixels, places, mapped(homography(places, pixels), around)


def described(description: str) -> tuple[Any, tuple[float, float]]:
    """OpenCV's board and its size [m]."""
    import cv2

    read = DESCRIPTION.fullmatch(description)
    if read is None:
        raise GarmentError(
            f"the board {description!r} does not read charuco:COLUMNSxROWS:SQUARE:MARKER with sides in mm; "
            "for example charuco:7x5:40:30"
        )
    columns, rows = int(read[1]), int(read[2])
    try:
        square, marker = float(read[3]) / 1000, float(read[4]) / 1000
    except ValueError:
        square = marker = 0.0
    name = (read[5] or "DICT_4X4_50").upper()
    known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
    if name not in known:
        raise GarmentError(f"OpenCV has no markers {name!r}; {did_you_mean(name, known)}")
    if not (2 <= columns <= 50 and 2 <= rows <= 50 and 0 < marker < square <= 1):
        raise GarmentError(
            f"the board {description!r} can't be: give 2 to 50 squares each way, of up to 1000 mm, and smaller markers"
        )
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
    if columns * rows // 2 > len(dictionary.bytesList):
        raise GarmentError(
            f"the markers {name} do not suffice for {columns} x {rows} squares; name a larger dictionary"
        )
    board = cv2.aruco.CharucoBoard((columns, rows), square, marker, dictionary)
    return board, (columns * square, rows * square)
