"""Pictures as files and as bytes."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.logs._disk.files import write_atomically


def png(rgb: NDArray[np.uint8]) -> bytes:
    """A picture, uint8, shape (H, W, 3), as PNG bytes; what a notebook's ``_repr_png_`` returns."""
    from PIL import Image

    buffer = BytesIO()
    Image.fromarray(np.ascontiguousarray(rgb)).save(buffer, format="PNG", compress_level=6)
    return buffer.getvalue()


def save(rgb: NDArray[np.uint8], path: str | Path) -> Path:
    """Write a picture, uint8, shape (H, W, 3), as PNG, making its folder if need be; returns the path."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, png(rgb))
    return path
