"""Small pictures of episodes, kept beside the records of a run: what was seen and done, fold by fold, then the end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import contour_of
from polyfold.types import Episode, Step
from polyfold.viz._draw._overlays import overlay
from polyfold.viz._pictures import action_map_of

LIMIT = 40_000
"""Most bytes of a picture."""

PANEL, GAP = 264, 2
SEAM = (206, 210, 216)
QUALITIES = (80, 65, 50, 30)


def thumbnail(episode: Episode, wanted: NDArray[np.bool_] | None = None) -> bytes:
    """The episode as a row of square panels, a WebP of at most ``LIMIT`` bytes.

    Args:
        episode: what happened; every fold is a panel, and the final picture the last one.
        wanted: the silhouette that was wanted, bool, shape (H, W); its outline is drawn over the last panel.
    """
    panels = [_step_panel(step) for step in episode.steps]
    panels.append(overlay(episode.final, outline=_outline(wanted)))
    return _compressed(panels)


def _step_panel(step: Step) -> NDArray[np.uint8]:
    return overlay(step.observation, None, step.fold_line, step.action, action_map=action_map_of(step))


def _outline(wanted: NDArray[np.bool_] | None) -> NDArray[np.float64] | None:
    return None if wanted is None or not wanted.any() else contour_of(wanted)


def _compressed(panels: list[NDArray[np.uint8]]) -> bytes:
    """The panels side by side, as sharp as the limit allows."""
    data = b""
    for size in (PANEL, PANEL // 2):
        strip = _row(panels, size)
        for quality in QUALITIES:
            data = _webp(strip, quality)
            if len(data) <= LIMIT:
                return data
    return data


def _row(panels: list[NDArray[np.uint8]], size: int) -> NDArray[np.uint8]:
    from PIL import Image

    row = np.full((size, len(panels) * (size + GAP) - GAP, 3), SEAM, np.uint8)
    for index, panel in enumerate(panels):
        # Drawn at the camera's size and then made smaller: strokes stay fine, and what covers what stays the same.
        small = Image.fromarray(panel).resize((size, size), Image.Resampling.LANCZOS)
        row[:, index * (size + GAP) : index * (size + GAP) + size] = np.asarray(small)
    return row


def _webp(rgb: NDArray[np.uint8], quality: int) -> bytes:
    from io import BytesIO

    from PIL import Image

    buffer = BytesIO()
    Image.fromarray(rgb).save(buffer, format="WEBP", quality=quality, method=4)
    return buffer.getvalue()
