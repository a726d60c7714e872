"""Turned and mirrored copies of training examples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from polyfold_fgpnp.policies.networks import NetworkConfig
from polyfold_fgpnp.training.examples import Examples


def augmented(examples: Examples, network: NetworkConfig, rng: np.random.Generator) -> Examples:
    """Turned and mirrored copies of examples: physics does not care.

    The canonical frame can only be mirrored along the fold line; the camera's also turned by quarters. Mirroring swaps
    start and end of the fold line, and with them which arm is the first along it.
    """
    images, lines, points = examples.images.copy(), examples.lines.copy(), examples.points.copy()
    side = images.shape[-1]
    for index in range(len(images)):
        if rng.random() < 0.5:
            images[index] = images[index][:, ::-1]
            points[index, ..., 1] = side - 1 - points[index, ..., 1]
            lines[index] = _reversed(lines[index], side) if network.frame == "camera" else lines[index]
            points[index] = points[index][:, ::-1] if network.variant == "2sam" else points[index]
        if network.frame == "camera":
            for _ in range(rng.integers(4)):
                images[index], points[index], lines[index] = _turned(images[index], points[index], lines[index], side)
    return replace(examples, images=images, lines=lines, points=points)


def _reversed(line: NDArray[np.float32], side: int) -> NDArray[np.float32]:
    """The fold line after mirroring the image's y, from end to start so that the same cloth stays on its left."""
    x0, y0, x1, y1 = line
    top = (side - 1) / side
    return np.array([x1, top - y1, x0, top - y0], np.float32)


def _turned(image: NDArray, points: NDArray, line: NDArray, side: int) -> tuple[NDArray, NDArray, NDArray]:
    """A quarter turn: (x, y) becomes (side - 1 - y, x)."""
    top = (side - 1) / side
    turned = np.stack([side - 1 - points[..., 1], points[..., 0]], -1)
    x0, y0, x1, y1 = line
    return np.rot90(image, -1, (1, 2)), turned, np.array([top - y0, x0, top - y1, x1], np.float32)
