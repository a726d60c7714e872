"""An episode as one strip of pictures: every step with its sentence, then the result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine
from polyfold.types import Action, ActionMap, Scene
from polyfold.viz._draw._canvas import Page, line_height, text_width, wrapped
from polyfold.viz._draw._overlays import Overlay
from polyfold.viz._draw._saving import save
from polyfold.viz._draw._style import ARMS, FAINT, FOLD_LINE, GOAL, INK, LIFTED, MAP, POLYGON, RULE, Colour
from polyfold.viz._draw._vector import VectorPage, is_vector

Image = NDArray[np.uint8]

PANEL, GAP, MARGIN = 400, 26, 26
HEADING, TITLE, CAPTION = 24, 17, 15


_Page = TypeVar("_Page", Page, VectorPage)
_Sign = tuple[str, str, Colour]
"""A line of the legend: sign, meaning and colour."""


@dataclass(frozen=True, eq=False)
class Frame:
    """One step of a filmstrip.

    Attributes:
        rgb: the picture that was seen, uint8, shape (H, W, 3).
        scene: the scene it was grounded to, if any.
        fold_line: the planned fold line, if any.
        action: the picks and places, if any.
        title: the step in words.
        caption: what stands below, such as the time it took.
        action_map: places to pick and the policy's values, if any.
        shown: what is shown in the picture's place, the same view at another size.
    """

    rgb: Image
    scene: Scene | None = None
    fold_line: FoldLine | None = None
    action: Action | None = None
    title: str = ""
    caption: str = ""
    action_map: ActionMap | None = None
    shown: Image | None = None


@dataclass(frozen=True, eq=False)
class _Panel:
    """A picture with the lines of text above and below it."""

    picture: Overlay
    title: list[str]
    caption: list[str]

    @property
    def height(self) -> int:
        """Of the picture [px]."""
        return round(self.picture.rgb.shape[0] * self.picture.zoom)


def filmstrip(
    frames: Sequence[Frame],
    result_rgb: Image,
    heading: str = "",
    result_caption: str = "",
    ideal_outline: ArrayLike | None = None,
    path: str | Path | None = None,
    *,
    result_title: str = "Result",
    columns: int = 5,
    result_shown: Image | None = None,
    sides: Sequence[tuple[str, Colour]] = (),
    photo: Image | None = None,
) -> Image:
    """Lay out an episode: one panel per step and a last one with the result, and write it if a path is given.

    Args:
        frames: the steps, in order; may be empty.
        result_rgb: the last picture, uint8, shape (H, W, 3).
        heading: the instruction.
        result_caption: how it came out, such as ``IoU 0.953, 4.2 mm``.
        ideal_outline: where the cloth should lie [px], shape (N, 2), dashed over the result.
        path: file to write: PNG, or PDF or SVG for papers, in which lines and words stay sharp at any size.
        result_title: what stands over the last panel.
        columns: most panels in a row.
        result_shown: what is shown in the last picture's place, the same view at another size.
        sides: what the sides of the cloth are called, and their colours.
        photo: the real garment that the simulated one is the twin of, shown first.

    Returns:
        The page, uint8, shape (H', W', 3).
    """
    panels = [] if photo is None else [_result_panel(Frame(photo), "The photo", "", None)]
    panels += [_step_panel(number, frame) for number, frame in enumerate(frames, start=1)]
    panels.append(_result_panel(Frame(result_rgb, shown=result_shown), result_title, result_caption, ideal_outline))
    rows = [panels[i : i + columns] for i in range(0, len(panels), columns)]
    signs = [("■", name, colour) for name, colour in sides]
    entries = [*signs, *_legend(frames, ideal_outline is not None)]
    page = _lay_out(Page, rows, heading, entries).image()
    if path is not None and is_vector(path):
        _lay_out(VectorPage, rows, heading, entries).save(path)
    elif path is not None:
        save(page, path)
    return page


def _step_panel(number: int, frame: Frame) -> _Panel:
    zoom = PANEL / max(frame.rgb.shape[:2])
    picture = Overlay(
        frame.rgb,
        frame.scene,
        frame.fold_line,
        frame.action,
        action_map=frame.action_map,
        zoom=zoom,
        shown=frame.shown,
    )
    title = wrapped(f"{number}. {frame.title}", TITLE, PANEL, bold=True)
    return _Panel(picture, title, wrapped(frame.caption, CAPTION, PANEL, most=2))


def _result_panel(frame: Frame, title: str, caption: str, ideal_outline: ArrayLike | None) -> _Panel:
    picture = Overlay(frame.rgb, outline=ideal_outline, zoom=PANEL / max(frame.rgb.shape[:2]), shown=frame.shown)
    return _Panel(picture, wrapped(title, TITLE, PANEL, bold=True), wrapped(caption, CAPTION, PANEL, most=6))


def _lay_out(sheet: type[_Page], rows: list[list[_Panel]], heading: str, entries: list[_Sign]) -> _Page:
    width = 2 * MARGIN + max(len(row) for row in rows) * (PANEL + GAP) - GAP
    heading_lines = wrapped(heading, HEADING, width - 2 * MARGIN, bold=True, most=3)
    top = MARGIN + (len(heading_lines) * line_height(HEADING) + 14 if heading_lines else 0)
    heights = [_row_height(row) for row in rows]
    legend = _legend_rows(entries, width - 2 * MARGIN + 24)
    legend_height = len(legend) * line_height(CAPTION) + 12 if legend else 0
    height = top + sum(heights) + (len(rows) - 1) * GAP + legend_height + MARGIN - 8
    page = sheet(width, height)
    page.lines(heading_lines, MARGIN, MARGIN - 4, HEADING, INK, bold=True)
    y = top
    for row, row_height in zip(rows, heights, strict=True):
        _lay_row(page, row, y)
        y += row_height + GAP
    if legend:
        _lay_legend(page, legend, MARGIN, y - GAP + 12)
    return page


def _row_height(row: list[_Panel]) -> int:
    captions = max(len(panel.caption) for panel in row) * line_height(CAPTION)
    return _titles_height(row) + _pictures_height(row) + 8 + captions


def _pictures_height(row: list[_Panel]) -> int:
    return max(panel.height for panel in row)


def _titles_height(row: list[_Panel]) -> int:
    return max(len(panel.title) for panel in row) * line_height(TITLE) + 8


def _lay_row(page: Page | VectorPage, row: list[_Panel], y: int) -> None:
    below_titles = y + _titles_height(row)
    below_pictures = below_titles + _pictures_height(row)
    for column, panel in enumerate(row):
        x = MARGIN + column * (PANEL + GAP)
        page.lines(panel.title, x, below_titles - 8 - len(panel.title) * line_height(TITLE), TITLE, INK, bold=True)
        page.drawing(panel.picture, x, below_titles, RULE)
        page.lines(panel.caption, x, below_pictures + 8, CAPTION, FAINT)
        if column:
            page.text("›", x - GAP / 2, (below_titles + below_pictures) / 2, 30, FAINT, anchor="mm")


def _legend(frames: Sequence[Frame], with_ideal: bool) -> list[_Sign]:
    """Sign, meaning and colour of what is drawn somewhere in the strip."""
    entries = _polygon_signs([frame.scene for frame in frames if frame.scene is not None])
    if any(frame.fold_line is not None for frame in frames):
        entries.append(("▲", "fold line, teeth on the lifted side", FOLD_LINE))
    if any(frame.fold_line is not None and frame.scene is not None for frame in frames):
        entries.append(("■", "lifted part, tinted", LIFTED))
    arms = max((frame.action.arms for frame in frames if frame.action is not None), default=0)
    names = ("pick → place",) if arms == 1 else ("first arm, pick → place", "second arm")
    entries += [("●", name, colour) for name, colour in zip(names[:arms], ARMS, strict=False)]
    if any(frame.action_map is not None for frame in frames):
        entries += [("●", "value of picking there: lowest", MAP[0]), ("●", "highest", MAP[-2])]
    if with_ideal:
        entries.append(("– –", "ideal outline", GOAL))
    return entries


def _polygon_signs(scenes: Sequence[Scene]) -> list[_Sign]:
    """What is drawn of the polygons that were fitted."""
    models = [scene.model for scene in scenes if scene.model is not None]
    entries = [("●–●", "fitted polygon", POLYGON)] if models else []
    if any("crease" in facet.edges for model in models for facet in model.facets()):
        entries.append(("– –", "crease", POLYGON))
    if any(not state.visible for model in models for state in model.vertices().values()):
        entries.append(("○", "covered vertex", POLYGON))
    return entries


def _legend_rows(entries: list[_Sign], width: float) -> list[list[_Sign]]:
    """The entries in as many rows as they need."""
    rows: list[list[_Sign]] = [[]]
    for entry in entries:
        if rows[-1] and sum(_sign_width(other) for other in [*rows[-1], entry]) > width:
            rows.append([])
        rows[-1].append(entry)
    return rows if entries else []


def _sign_width(entry: _Sign) -> float:
    sign, meaning, _ = entry
    return text_width(sign, CAPTION, bold=True) + 6 + text_width(meaning, CAPTION) + 24


def _lay_legend(page: Page | VectorPage, rows: list[list[_Sign]], x: float, y: float) -> None:
    for number, row in enumerate(rows):
        at, top = x, y + number * line_height(CAPTION)
        for sign, meaning, colour in row:
            page.text(sign, at, top, CAPTION, colour, bold=True)
            page.text(meaning, at + text_width(sign, CAPTION, bold=True) + 6, top, CAPTION, FAINT)
            at += _sign_width((sign, meaning, colour))
