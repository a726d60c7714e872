"""An image to draw smooth shapes on: everything is drawn at several times the resolution and then averaged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.viz._draw._style import INK, PAPER, Colour, font

Image = NDArray[np.uint8]


class Surface(Protocol):
    """What shapes are drawn on: pixels (:class:`Canvas`) or a page of shapes (``VectorCanvas``)."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the result [px]."""
        ...

    def length(self, pixels: float) -> float:
        """A length of the result [px] in pixels of the picture given."""
        ...

    def line(self, points: ArrayLike, colour: Colour, width: float, dash: float = 0.0, opacity: float = 1.0) -> None:
        """A polyline with round ends, shape (N, 2), dashed where ``dash`` [px] is given."""

    def fill(self, polygon: ArrayLike, colour: Colour, opacity: float = 1.0) -> None:
        """A filled polygon, shape (N, 2)."""

    def tint(self, mask: NDArray[np.bool_], colour: Colour, opacity: float) -> None:
        """Colour laid over a mask of the picture given, shape (H, W)."""

    def disc(self, centre: ArrayLike, radius: float, colour: Colour) -> None:
        """A filled disc."""

    def text(self, text: str, at: ArrayLike, size: int, colour: Colour, anchor: str) -> None:
        """One line of text at a point of the picture given; ``anchor`` as in Pillow."""


class Drawing(Protocol):
    """A picture and what is drawn over it."""

    @property
    def rgb(self) -> Image:
        """The picture, uint8, shape (H, W, 3)."""
        ...

    @property
    def zoom(self) -> float:
        """Size of the result relative to the picture."""
        ...

    @property
    def shown(self) -> Image | None:
        """What is shown in the picture's place, the same view at another size."""
        ...

    def on(self, surface: Surface) -> None:
        """Draw what is over the picture."""

    def image(self) -> Image:
        """All of it as pixels."""
        ...


class Canvas:
    """Shapes over a picture; points are pixels (x, y) of the picture given, ``zoom`` enlarges what comes out.

    Widths and radii are pixels of the result, so that lines look alike at every zoom.

    Args:
        rgb: the picture, uint8, shape (H, W, 3).
        zoom: size of the result relative to the picture.
        shown: what is shown in its place: the same view at another size.
    """

    OVERSAMPLE = 4

    def __init__(self, rgb: Image, zoom: float = 1.0, shown: Image | None = None) -> None:
        from PIL import Image as Pillow

        height, width = rgb.shape[:2]
        size = (round(width * zoom), round(height * zoom))
        picture = Pillow.fromarray(np.ascontiguousarray(rgb if shown is None else shown))
        if size != picture.size:
            picture = picture.resize(size, Pillow.Resampling.LANCZOS)
        self._image = picture.resize((size[0] * self.OVERSAMPLE, size[1] * self.OVERSAMPLE), Pillow.Resampling.NEAREST)
        self._scale = np.array(size) / (width, height) * self.OVERSAMPLE

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the result [px]."""
        return self._image.width // self.OVERSAMPLE, self._image.height // self.OVERSAMPLE

    def image(self) -> Image:
        """The picture with all that was drawn, uint8, shape (zoom H, zoom W, 3); untouched pixels are unchanged."""
        return np.asarray(self._image.reduce(self.OVERSAMPLE))

    def length(self, pixels: float) -> float:
        """A length of the result [px] in pixels of the picture given."""
        return float(pixels * self.OVERSAMPLE / self._scale[0])

    def line(self, points: ArrayLike, colour: Colour, width: float, dash: float = 0.0, opacity: float = 1.0) -> None:
        """A polyline with round ends, shape (N, 2), dashed where ``dash`` [px] is given."""
        at = self._to_image(points)
        pieces = dashes(at, dash * self.OVERSAMPLE) if dash else [at]
        self._paint(pieces, colour, opacity, width * self.OVERSAMPLE)

    def fill(self, polygon: ArrayLike, colour: Colour, opacity: float = 1.0) -> None:
        """A filled polygon, shape (N, 2)."""
        self._paint([self._to_image(polygon)], colour, opacity, None)

    def tint(self, mask: NDArray[np.bool_], colour: Colour, opacity: float) -> None:
        """Colour laid over a mask of the picture given, shape (H, W)."""
        from PIL import Image as Pillow

        cover = Pillow.fromarray((mask * round(255 * opacity)).astype(np.uint8))
        self._image.paste(colour, (0, 0), cover.resize(self._image.size, Pillow.Resampling.BILINEAR))

    def disc(self, centre: ArrayLike, radius: float, colour: Colour) -> None:
        """A filled disc."""
        from PIL import ImageDraw

        x, y = self._to_image(centre)[0]
        r = radius * self.OVERSAMPLE
        ImageDraw.Draw(self._image).ellipse((x - r, y - r, x + r, y + r), fill=colour)

    def text(self, text: str, at: ArrayLike, size: int, colour: Colour, anchor: str) -> None:
        """One line of text at a point of the picture given; ``anchor`` as in Pillow."""
        from PIL import ImageDraw

        x, y = self._to_image(at)[0]
        draw = ImageDraw.Draw(self._image)
        draw.text((x, y), text, fill=colour, font=font(size * self.OVERSAMPLE), anchor=anchor)

    def _to_image(self, points: ArrayLike) -> NDArray[np.float64]:
        return (np.asarray(points, float).reshape(-1, 2) + 0.5) * self._scale - 0.5

    def _paint(self, shapes: Sequence[NDArray], colour: Colour, opacity: float, width: float | None) -> None:
        from PIL import ImageDraw

        if opacity >= 1.0:
            draw = ImageDraw.Draw(self._image)
            for shape in shapes:
                _draw_shape(draw, shape, colour, width)
        else:
            self._cover(shapes, colour, opacity, width)

    def _cover(self, shapes: Sequence[NDArray], colour: Colour, opacity: float, width: float | None) -> None:
        """Shapes through which the picture shows; where they overlap it shows no less."""
        from PIL import Image as Pillow
        from PIL import ImageDraw

        margin = (width or 0) + 1
        everything = np.vstack(shapes)
        left, top = (int(side) for side in np.floor(everything.min(0) - margin))
        right, bottom = (int(side) for side in np.ceil(everything.max(0) + margin))
        cover = Pillow.new("L", (right - left, bottom - top), 0)
        draw = ImageDraw.Draw(cover)
        for shape in shapes:
            _draw_shape(draw, shape - np.array([left, top]), round(255 * opacity), width)
        self._image.paste(colour, (left, top), cover)


def _draw_shape(draw, shape: NDArray, fill, width: float | None) -> None:
    flat = [tuple(point) for point in shape.tolist()]
    if width is None:
        draw.polygon(flat, fill=fill)
        return
    draw.line(flat, fill=fill, width=max(1, round(width)), joint="curve")
    r = width / 2
    for x, y in (flat[0], flat[-1]):
        draw.ellipse((x - r, y - r, x + r, y + r), fill=fill)


def dashes(points: NDArray, length: float) -> list[NDArray]:
    """Pieces of a polyline, each about ``length`` long with a gap of the same length; it starts and ends with one."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    position = np.concatenate([[0.0], np.cumsum(steps)])
    total = position[-1]
    count = max(1, round((total / length + 1) / 2))
    piece = total / (2 * count - 1)
    found = []
    for begin in np.arange(count) * 2 * piece:
        inner = points[(position > begin) & (position < begin + piece)]
        ends = [_at(points, position, begin), _at(points, position, begin + piece)]
        found.append(np.vstack([ends[0], inner, ends[1]]))
    return found


def _at(points: NDArray, position: NDArray, where: float) -> NDArray:
    return np.array([np.interp(where, position, points[:, 0]), np.interp(where, position, points[:, 1])])


class Page:
    """A sheet of paper to lay pictures and text on; coordinates are pixels from its top-left corner."""

    def __init__(self, width: int, height: int, colour: Colour = PAPER) -> None:
        from PIL import Image as Pillow
        from PIL import ImageDraw

        self._image = Pillow.new("RGB", (width, height), colour)
        self._draw = ImageDraw.Draw(self._image)

    @classmethod
    def over(cls, rgb: Image) -> Page:
        """A page that shows a picture, uint8, shape (H, W, 3), to write on."""
        page = cls(rgb.shape[1], rgb.shape[0])
        page.picture(rgb, 0, 0)
        return page

    def image(self) -> Image:
        """The page, uint8, shape (height, width, 3)."""
        return np.asarray(self._image)

    def picture(self, rgb: Image, x: int, y: int, frame: Colour | None = None) -> None:
        """Put a picture, uint8, shape (H, W, 3), with its top-left corner at (x, y) [px], inside a thin frame."""
        from PIL import Image as Pillow

        height, width = rgb.shape[:2]
        self._image.paste(Pillow.fromarray(np.ascontiguousarray(rgb)), (x, y))
        if frame:
            self._draw.rectangle((x - 1, y - 1, x + width, y + height), outline=frame)

    def drawing(self, drawing: Drawing, x: int, y: int, frame: Colour) -> None:
        """Put a picture with what is drawn over it."""
        self.picture(drawing.image(), x, y, frame)

    def text(
        self, text: str, x: float, y: float, size: int, colour: Colour = INK, bold: bool = False, anchor: str = "la"
    ) -> None:
        """One line of text; ``anchor`` as in Pillow: ``la`` left and top, ``mm`` middle."""
        self._draw.text((x, y), text, fill=colour, font=font(size, bold), anchor=anchor)

    def lines(
        self, lines: Sequence[str], x: float, y: float, size: int, colour: Colour = INK, bold: bool = False
    ) -> None:
        """Several lines of text, left-aligned."""
        for number, line in enumerate(lines):
            self.text(line, x, y + number * line_height(size), size, colour, bold)


def line_height(size: int) -> int:
    """Distance between lines of text [px]."""
    return round(size * 1.32)


def text_width(text: str, size: int, bold: bool = False) -> float:
    """Width of one line of text [px]."""
    return float(font(size, bold).getlength(text))


def wrapped(text: str, size: int, width: float, bold: bool = False, most: int = 4) -> list[str]:
    """Text broken into at most ``most`` lines no wider than ``width`` [px]; what doesn't fit ends in an ellipsis."""
    lines = list(_broken(text, size, width, bold))
    if len(lines) > most:
        kept = lines[most - 1]
        while kept and text_width(kept + "…", size, bold) > width:
            kept = kept[:-1]
        lines = [*lines[: most - 1], kept.rstrip() + "…"]
    return lines


def _broken(text: str, size: int, width: float, bold: bool) -> Iterator[str]:
    line = ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if text_width(longer, size, bold) <= width:
            line = longer
            continue
        if line:
            yield line
        while text_width(word, size, bold) > width and len(word) > 1:
            fits = next(n for n in range(len(word) - 1, 0, -1) if n == 1 or text_width(word[:n], size, bold) <= width)
            yield word[:fits]
            word = word[fits:]
        line = word
    if line:
        yield line


def resized(rgb: Image, width: int, height: int) -> Image:
    """A picture at another size, uint8, shape (height, width, 3)."""
    from PIL import Image as Pillow

    if rgb.shape[:2] == (height, width):
        return rgb
    picture = Pillow.fromarray(np.ascontiguousarray(rgb)).resize((width, height), Pillow.Resampling.LANCZOS)
    return np.asarray(picture)


def fitted(rgb: Image, side: int, colour: Colour = PAPER) -> Image:
    """A picture fitted into a square of ``side`` [px], centred on paper, uint8, shape (side, side, 3)."""
    height, width = rgb.shape[:2]
    scale = side / max(height, width)
    small = resized(rgb, max(1, round(width * scale)), max(1, round(height * scale)))
    square = np.full((side, side, 3), colour, np.uint8)
    y, x = (side - small.shape[0]) // 2, (side - small.shape[1]) // 2
    square[y : y + small.shape[0], x : x + small.shape[1]] = small
    return square
