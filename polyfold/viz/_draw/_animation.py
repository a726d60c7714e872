"""Animations small enough for a README."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold.logs._disk.files import write_atomically
from polyfold.viz._draw._canvas import resized

Image = NDArray[np.uint8]


def gif(
    frames: Sequence[Image],
    path: str | Path,
    fps: float = 12.0,
    *,
    hold_s: float = 1.5,
    holds: Mapping[int, float] | None = None,
    max_bytes: int = 3_000_000,
) -> Path:
    """Write frames as an endless GIF with one palette for all; the last frame is held before it starts again.

    A file larger than ``max_bytes`` is made again at three quarters of the size, until it fits.

    Args:
        frames: pictures of one size, uint8, shape (H, W, 3).
        path: file to write; its folder is made if need be.
        fps: frames per second; GIF rounds the duration to 10 ms.
        hold_s: how long the last frame stays [s].
        holds: how long others stay, by their number from 0, that stay longer than the rest [s].
        max_bytes: largest file allowed.

    Raises:
        ConfigError: if there are no frames or they differ in size.
    """
    if not len(frames):
        raise ConfigError("an animation needs at least one frame; give the pictures in order")
    if len({frame.shape for frame in frames}) > 1:
        raise ConfigError("the frames of an animation differ in size; bring them to one size first")
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    durations = [max(20, round(100 / fps) * 10)] * len(frames)
    for number, seconds in {**(holds or {}), len(frames) - 1: hold_s}.items():
        durations[number] = round(seconds * 1000)
    while True:
        encoded = _encoded(frames, durations)
        height, width = frames[0].shape[:2]
        if len(encoded) <= max_bytes or min(height, width) < 64:
            write_atomically(path, encoded)
            return path
        frames = [resized(frame, round(width * 0.75), round(height * 0.75)) for frame in frames]


def _encoded(frames: Sequence[Image], durations: list[int]) -> bytes:
    from PIL import Image as Pillow

    palette = _palette(frames)
    indexed = [
        Pillow.fromarray(np.ascontiguousarray(frame)).quantize(palette=palette, dither=Pillow.Dither.NONE)
        for frame in frames
    ]
    buffer = BytesIO()
    how = {"save_all": True, "duration": durations, "loop": 0, "optimize": True, "disposal": 1}
    indexed[0].save(buffer, format="GIF", append_images=indexed[1:], **how)
    return buffer.getvalue()


def _palette(frames: Sequence[Image]) -> Any:
    """128 colours chosen from every frame; from every few pixels of it where there are many."""
    from PIL import Image as Pillow

    stride = max(1, round((sum(frame.size // 3 for frame in frames) / 500_000) ** 0.5))
    sample = np.vstack([frame[::stride, ::stride] for frame in frames])
    return Pillow.fromarray(np.ascontiguousarray(sample)).quantize(128, method=Pillow.Quantize.MEDIANCUT)
