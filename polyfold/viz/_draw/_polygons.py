"""The polygon model with all its names: what grounding found, to look at or to print."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import signed_distance
from polyfold.viz._draw._canvas import Canvas, Page, line_height, text_width, wrapped
from polyfold.viz._draw._drawing import draw_model
from polyfold.viz._draw._saving import save
from polyfold.viz._draw._style import FAINT, INK, PAPER, Colour

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel


Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

SIDE, MARGIN, GAP, LABEL, TITLE = 560, 24, 22, 15, 18
FRONT: Colour = (126, 170, 202)
BACK: Colour = (226, 217, 203)
TABLE: Colour = (244, 244, 242)
SAME_PLACE_PX = 4.0
"""Vertices closer than this share one label."""


@dataclass(frozen=True, eq=False)
class _Label:
    """The name, or names, at one place of the picture [px]."""

    text: str
    point: Floats
    colour: Colour


def polygon_picture(model: FoldedModel, image_size: tuple[int, int] = (400, 400), zoom: float = 1.0) -> Image:
    """The model alone, as paper cut-outs: front blue, reverse side sand, edges and vertices as in an overlay.

    Args:
        model: the model [px].
        image_size: (width, height) of the image that the model lies in [px].
        zoom: size of the result relative to the image.

    Returns:
        uint8, shape (zoom * height, zoom * width, 3).
    """
    width, height = image_size
    canvas = Canvas(np.full((height, width, 3), TABLE, np.uint8), zoom)
    for facet in sorted(model.facets(), key=lambda facet: facet.layer):
        canvas.fill(facet.polygon, BACK if facet.flipped else FRONT)
    draw_model(canvas, model)
    return canvas.image()


def grounding_picture(rgb: Image, model: FoldedModel, title: str = "", path: str | Path | None = None) -> Image:
    """The picture with the fitted polygon and the name of every vertex beside it, joined by thin lines.

    Vertices that lie in one place share a label; names of hidden ones are grey.

    Args:
        rgb: what was seen, uint8, shape (H, W, 3); or :func:`polygon_picture`.
        model: the fitted model [px].
        title: what stands above, such as the Chamfer distance.
        path: PNG to write.

    Returns:
        The page, uint8, shape (H', W', 3).
    """
    zoom = SIDE / max(rgb.shape[:2])
    canvas = Canvas(rgb, zoom)
    draw_model(canvas, model)
    picture = canvas.image()
    height, width = picture.shape[:2]
    left, right = _sides(_labels(model), zoom)
    side_width = max(_text_width(left), _text_width(right)) + GAP
    page_width = 2 * (MARGIN + side_width) + width
    title_lines = wrapped(title, TITLE, page_width - 2 * MARGIN, bold=True)
    x, y = MARGIN + side_width, MARGIN + (len(title_lines) * line_height(TITLE) + 12 if title_lines else 0)
    blank = np.full((y + height + MARGIN, page_width, 3), PAPER, np.uint8)
    blank[y : y + height, x : x + width] = picture
    left, rows_left = _untangled(left, height, -6.0)
    right, rows_right = _untangled(right, height, width + 6.0)
    joined = _join(blank, left, rows_left, x, y, x - 6)
    joined = _join(joined, right, rows_right, x, y, x + width + 6)
    page = Page.over(joined)
    page.lines(title_lines, MARGIN, MARGIN - 4, TITLE, INK, bold=True)
    for label, row in zip(left, rows_left, strict=True):
        page.text(label.text, x - 10, y + row, LABEL, label.colour, anchor="rm")
    for label, row in zip(right, rows_right, strict=True):
        page.text(label.text, x + width + 10, y + row, LABEL, label.colour, anchor="lm")
    image = page.image()
    if path is not None:
        save(image, path)
    return image


def _labels(model: FoldedModel) -> list[_Label]:
    """One label for each place, in the model's order."""
    groups: list[tuple[Floats, list[str], bool]] = []
    for name, state in model.vertices().items():
        for number, (point, names, visible) in enumerate(groups):
            if np.hypot(*(point - state.point)) < SAME_PLACE_PX:
                names.append(name)
                groups[number] = (point, names, visible or state.visible)
                break
        else:
            groups.append((np.asarray(state.point, float), [name], state.visible))
    return [_Label(" = ".join(names), point, INK if visible else FAINT) for point, names, visible in groups]


def _sides(labels: Sequence[_Label], zoom: float) -> tuple[list[_Label], list[_Label]]:
    """Labels for the left and the right margin, half each, from top to bottom; their points in pixels of the page."""
    placed = [_Label(label.text, (label.point + 0.5) * zoom - 0.5, label.colour) for label in labels]
    by_x = sorted(placed, key=lambda label: label.point[0])
    half = (len(by_x) + 1) // 2
    return _by_height(by_x[:half]), _by_height(by_x[half:])


def _by_height(labels: list[_Label]) -> list[_Label]:
    return sorted(labels, key=lambda label: float(label.point[1]))


def _untangled(labels: list[_Label], height: int, text_x: float) -> tuple[list[_Label], Floats]:
    """Labels in an order in which the lines to their points don't cross, and their heights [px]."""
    rows = _rows(labels, height)
    for _ in range(len(labels)):
        crossing = [i for i in range(len(labels) - 1) if _cross(labels[i], rows[i], labels[i + 1], rows[i + 1], text_x)]
        if not crossing:
            break
        for i in crossing[::2]:
            labels = [*labels[:i], labels[i + 1], labels[i], *labels[i + 2 :]]
        rows = _rows(labels, height)
    return labels, rows


def _cross(upper: _Label, upper_row: float, lower: _Label, lower_row: float, text_x: float) -> bool:
    """Whether the lines from two neighbouring labels to their points meet."""

    def side(point: Floats, start: Floats, end: Floats) -> bool:
        return float(signed_distance(point, start, end)) > 0

    a, b = np.array([text_x, upper_row]), np.array([text_x, lower_row])
    p, q = upper.point, lower.point
    return side(b, a, p) != side(q, a, p) and side(a, b, q) != side(p, b, q)


def _rows(labels: Sequence[_Label], height: int) -> Floats:
    """Heights [px] for labels, as near their points as they fit below each other."""
    wanted = np.array([label.point[1] for label in labels], float)
    space = line_height(LABEL) + 5
    steps = space * np.arange(len(wanted), dtype=float)
    rows: Floats = np.maximum.accumulate(wanted - steps) + steps
    last = height - space / 2
    for i in range(len(rows) - 1, -1, -1):
        rows[i] = min(rows[i], last)
        last = rows[i] - space
    return rows


def _text_width(labels: Sequence[_Label]) -> int:
    return round(max((text_width(label.text, LABEL) for label in labels), default=0))


def _join(page: Image, labels: Sequence[_Label], rows: Floats, x: int, y: int, text_x: float) -> Image:
    """Thin lines from each label to its vertex, ending just outside the dot."""
    canvas = Canvas(page)
    for label, row in zip(labels, rows, strict=True):
        begin, end = np.array([text_x, y + row]), label.point + np.array([x, y])
        way = end - begin
        end = end - way / max(float(np.hypot(*way)), 1e-9) * 5
        canvas.line([begin, end], PAPER, 2.6, opacity=0.6)
        canvas.line([begin, end], FAINT, 1.1)
    return canvas.image()
