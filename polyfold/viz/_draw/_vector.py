"""Pages and canvases that are written as PDF or SVG: lines stay lines and words stay words at any size."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ConfigError
from polyfold.logs._disk.files import write_atomically
from polyfold.viz._draw._canvas import Drawing, dashes, line_height
from polyfold.viz._draw._style import INK, PAPER, Colour

Image = NDArray[np.uint8]

FORMATS = (".pdf", ".svg")
"""Endings of files that hold shapes and not pixels."""
DPI = 96
"""Pixels of the page are CSS pixels."""
POINTS = 72 / DPI
ASCENT = 0.928
"""How far DejaVu Sans stands above its baseline, in its size."""
_ANCHORS = {"l": "left", "m": "center", "r": "right"}


def is_vector(path: str | Path) -> bool:
    """Whether a file is one of shapes. Raises ConfigError for an ending that is no picture's that we write."""
    ending = Path(path).suffix.lower()
    if ending not in (*FORMATS, ".png"):
        raise ConfigError(f"{str(path)!r} is no name for a picture; end it in .png, .pdf or .svg")
    return ending in FORMATS


class VectorPage:
    """A sheet to lay pictures and text on, as :class:`polyfold.viz._draw._canvas.Page`, drawn by matplotlib."""

    def __init__(self, width: int, height: int, colour: Colour = PAPER) -> None:
        from matplotlib.figure import Figure

        self._figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=_rgb(colour))
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set(xlim=(0, width), ylim=(height, 0))
        self._axes.axis("off")

    def drawing(self, drawing: Drawing, x: int, y: int, frame: Colour | None = None) -> None:
        """Put a picture with what is drawn over it, its top-left corner at (x, y) [px], inside a thin frame."""
        from matplotlib.patches import Rectangle

        canvas = VectorCanvas(self._axes, drawing.rgb, drawing.zoom, drawing.shown, x, y)
        drawing.on(canvas)
        if frame:
            line = Rectangle((x, y), *canvas.size, fill=False, edgecolor=_rgb(frame), linewidth=POINTS, zorder=3)
            self._axes.add_patch(line)

    def text(
        self, text: str, x: float, y: float, size: int, colour: Colour = INK, bold: bool = False, anchor: str = "la"
    ) -> None:
        """One line of text; ``anchor`` as in Pillow: ``la`` left and top, ``mm`` middle."""
        middle = anchor[1] == "m"
        self._axes.text(
            x, y if middle else y + ASCENT * size, text.replace("$", r"\$"), fontsize=size * POINTS, color=_rgb(colour),
            weight="bold" if bold else "normal", ha=_ANCHORS[anchor[0]], va="center_baseline" if middle else "baseline",
            family="DejaVu Sans",
        )  # fmt: skip

    def lines(
        self, lines: Sequence[str], x: float, y: float, size: int, colour: Colour = INK, bold: bool = False
    ) -> None:
        """Several lines of text, left-aligned."""
        for number, line in enumerate(lines):
            self.text(line, x, y + number * line_height(size), size, colour, bold)

    def save(self, path: str | Path) -> Path:
        """Write it; the ending of the path says as what."""
        from matplotlib import rc_context

        path, buffer = Path(path), BytesIO()
        # Text as text, and no date: what is drawn alike is the same file.
        settings: Any = {"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "polyfold"}
        dates: dict[str, Any] = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
        with rc_context(settings):
            self._figure.savefig(
                buffer, format=path.suffix[1:].lower(), metadata=dates[path.suffix.lower()], dpi=3 * DPI
            )
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, buffer.getvalue())
        return path


class VectorCanvas:
    """Shapes over a picture on a page, as :class:`polyfold.viz._draw._canvas.Canvas`."""

    def __init__(self, axes: Any, rgb: Image, zoom: float, shown: Image | None, x: float, y: float) -> None:
        from matplotlib.patches import Rectangle

        height, width = rgb.shape[:2]
        self._size = np.array([round(width * zoom), round(height * zoom)])
        self._scale = self._size / (width, height)
        self._corner = np.array([x, y], float)
        self._axes = axes
        self._extent = (x, x + self._size[0], y + self._size[1], y)
        limits = axes.get_xlim(), axes.get_ylim()
        axes.imshow(rgb if shown is None else shown, extent=self._extent, interpolation="lanczos", zorder=1)
        axes.set(xlim=limits[0], ylim=limits[1], aspect="auto")
        self._clip = Rectangle((x, y), *self._size, transform=axes.transData)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the result [px]."""
        return int(self._size[0]), int(self._size[1])

    def length(self, pixels: float) -> float:
        """A length of the result [px] in pixels of the picture given."""
        return float(pixels / self._scale[0])

    def line(self, points: ArrayLike, colour: Colour, width: float, dash: float = 0.0, opacity: float = 1.0) -> None:
        """A polyline with round ends, shape (N, 2), dashed where ``dash`` [px] is given."""
        at = self._on_page(points)
        for piece in dashes(at, dash) if dash else [at]:
            (drawn,) = self._axes.plot(
                *piece.T, color=_rgb(colour), linewidth=width * POINTS, alpha=opacity, zorder=2,
                solid_capstyle="round", solid_joinstyle="round",
            )  # fmt: skip
            drawn.set_clip_path(self._clip)

    def fill(self, polygon: ArrayLike, colour: Colour, opacity: float = 1.0) -> None:
        """A filled polygon, shape (N, 2)."""
        from matplotlib.patches import Polygon

        self._add(Polygon(self._on_page(polygon), facecolor=_rgb(colour), alpha=opacity, linewidth=0, zorder=2))

    def tint(self, mask: NDArray[np.bool_], colour: Colour, opacity: float) -> None:
        """Colour laid over a mask of the picture given, shape (H, W)."""
        cover = np.zeros((*mask.shape, 4))
        cover[..., :3], cover[..., 3] = _rgb(colour), mask * opacity
        self._axes.imshow(cover, extent=self._extent, interpolation="bilinear", zorder=1.5, aspect="auto")

    def disc(self, centre: ArrayLike, radius: float, colour: Colour) -> None:
        """A filled disc."""
        from matplotlib.patches import Circle

        x, y = self._on_page(centre)[0]
        self._add(Circle((float(x), float(y)), radius, facecolor=_rgb(colour), linewidth=0, zorder=2))

    def text(self, text: str, at: ArrayLike, size: int, colour: Colour, anchor: str) -> None:
        """One line of text at a point of the picture given; ``anchor`` as in Pillow."""
        x, y = self._on_page(at)[0]
        self._axes.text(
            x, y, text, fontsize=size * POINTS, color=_rgb(colour), ha=_ANCHORS[anchor[0]], va="center_baseline",
            family="DejaVu Sans", zorder=3,
        )  # fmt: skip

    def _add(self, patch: Any) -> None:
        self._axes.add_patch(patch)
        patch.set_clip_path(self._clip)

    def _on_page(self, points: ArrayLike) -> NDArray[np.float64]:
        return self._corner + (np.asarray(points, float).reshape(-1, 2) + 0.5) * self._scale


def _rgb(colour: Colour) -> tuple[float, float, float]:
    return colour[0] / 255, colour[1] / 255, colour[2] / 255
