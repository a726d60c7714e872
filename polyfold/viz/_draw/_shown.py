"""Pictures and animations that a notebook shows by themselves."""

from __future__ import annotations

import tempfile
from base64 import b64encode
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.viz._draw._animation import gif
from polyfold.viz._draw._saving import png

Image = NDArray[np.uint8]


class Picture:
    """An image that Jupyter displays."""

    def __init__(self, rgb: Image) -> None:
        self.rgb = rgb

    def _repr_png_(self) -> bytes:
        return png(self.rgb)


class Animation:
    """A GIF that Jupyter displays."""

    def __init__(self, content: bytes) -> None:
        self.content = content

    def _repr_html_(self) -> str:
        return f'<img src="data:image/gif;base64,{b64encode(self.content).decode()}" alt="animation">'


def show(rgb: Image) -> Picture:
    """An image, uint8, shape (H, W, 3), as the value of a notebook cell."""
    return Picture(rgb)


def animate(frames: Sequence[Image], fps: float = 12.0) -> Animation:
    """Frames of one size, uint8, shape (H, W, 3), as an animation in a notebook."""
    with tempfile.TemporaryDirectory() as folder:
        return Animation(gif(frames, Path(folder) / "animation.gif", fps).read_bytes())
