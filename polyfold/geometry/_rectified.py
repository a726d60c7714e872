"""Photographs of a table taken at an angle, measured: what a sheet or a board of known size beside the cloth tells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.geometry._charuco import find_board
from polyfold.geometry._homography import homography, mapped
from polyfold.geometry._paper import find_paper

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

SHEETS = {
    "a3": (0.420, 0.297),
    "a4": (0.297, 0.210),
    "a5": (0.210, 0.148),
    "letter": (0.2794, 0.2159),
}
"""Sheets of paper: longer and shorter side [m]."""


@dataclass(frozen=True, eq=False)
class Rectified:
    """How pixels of a photograph map to metres on the table.

    Attributes:
        to_metres: homography from pixels (x, y) to metres on the table, x right and y down as in the photograph, the
            origin at the sheet, shape (3, 3).
        corners: of the sheet or board in the photograph [px], shape (N, 2), around it.
        residual: how far the corners found are from where they should be [px], 0 for a sheet of four corners.
    """

    to_metres: Floats
    corners: Floats
    residual: float = 0.0

    def on_table(self, pixels: ArrayLike) -> Floats:
        """Places on the table [m], shape (N, 2), of pixels, shape (N, 2).

        Raises:
            GarmentError: if some are so near the horizon that they are on no table.
        """
        return mapped(self.to_metres, np.asarray(pixels, float))

    def in_photo(self, places: ArrayLike) -> Floats:
        """Pixels, shape (N, 2), of places on the table [m], shape (N, 2)."""
        return mapped(np.asarray(np.linalg.inv(self.to_metres), np.float64), np.asarray(places, float))

    def pixels_per_metre(self, pixels: ArrayLike) -> float:
        """The photograph's scale around some pixels, shape (N, 2): the median of what areas are magnified by [px/m]."""
        at = np.asarray(pixels, float)
        u, v = (self.on_table(at + step) - self.on_table(at) for step in np.eye(2))
        area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        return float(1.0 / np.sqrt(np.median(area)))


def rectify(rgb: Picture, sheet: str) -> Rectified:
    """Find the sheet or board in a photograph of a table and measure with it.

    Args:
        rgb: the photograph, uint8, shape (H, W, 3), of a lens without much distortion.
        sheet: ``a3``, ``a4``, ``a5`` or ``letter`` for a white sheet, or a ChArUco board as
            ``charuco:COLUMNSxROWS:SQUARE:MARKER`` with sides in millimetres, optionally followed by ``:DICTIONARY`` of
            OpenCV (``DICT_4X4_50`` by default).

    Raises:
        GarmentError: if there is none, or the description can't be read.
    """
    if sheet.lower().startswith("charuco"):
        corners, places, outline = find_board(rgb, sheet)
        return _fitted(corners, places, outline)
    sides = SHEETS.get(sheet.lower())
    if sides is None:
        raise GarmentError(
            f"there is no sheet {sheet!r}; give {', '.join(SHEETS)}, or a board: "
            "charuco:COLUMNSxROWS:SQUARE:MARKER with sides in mm"
        )
    corners, (across, down) = find_paper(rgb, sides, sheet)
    places = np.array([[0.0, 0.0], [across, 0.0], [across, down], [0.0, down]])
    return _fitted(corners, places, corners)


def _fitted(corners: Floats, places: Floats, outline: Floats) -> Rectified:
    found = homography(corners, places)
    # In front of the camera the denominator is positive, so that points beyond the horizon can be told.
    found *= np.sign(found[2] @ [*corners.mean(axis=0), 1.0])
    off = np.linalg.norm(mapped(np.linalg.inv(found), places) - corners, axis=1)
    return Rectified(found, outline, float(np.sqrt(np.mean(off**2))))
