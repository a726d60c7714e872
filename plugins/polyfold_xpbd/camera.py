"""The camera: a z-buffer rasteriser for colour and depth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import Camera
from polyfold.types import Observation
from polyfold_xpbd.ahead.calling import ahead
from polyfold_xpbd.kernels import picture

TABLE = (236, 236, 232)
"""Colour of the table, RGB."""
SAMPLES = 2
"""Samples per pixel and axis."""
rasterise, average = ahead("rasterise", picture.rasterise), ahead("average", picture.average)


def take_picture(
    camera: Camera,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    outside_up: NDArray[np.bool_],
    colours: tuple[tuple[int, int, int], tuple[int, int, int]],
) -> Observation:
    """Render the cloth on the table.

    Args:
        camera: the camera.
        positions: particle positions [m], shape (N, 3).
        normals: unit normals of the particles, shape (N, 3).
        triangles: vertex indices, shape (T, 3).
        outside_up: whether a triangle's counter-clockwise side is the garment's outside, shape (T,).
        colours: outside and inside colour, RGB.
    """
    pixels = camera.to_pixels(positions)
    screen = np.empty((len(positions), 3), np.float32)
    screen[:, :2] = (pixels + 0.5) * SAMPLES - 0.5
    screen[:, 2] = camera.elevation - positions[:, 2]
    size = (camera.height * SAMPLES, camera.width * SAMPLES)
    depth = np.full(size, np.float32(camera.elevation), np.float32)
    shade = np.zeros((*size, 3), np.float32)
    shade[:] = np.array(TABLE, np.float32)
    rasterise(screen, normals, triangles, outside_up, np.array(colours, np.float32), depth, shade)
    rgb = np.empty((camera.height, camera.width, 3), np.uint8)
    out = np.empty((camera.height, camera.width), np.float32)
    average(depth, shade, np.float32(camera.elevation), rgb, out)
    return Observation(rgb, out, camera)
