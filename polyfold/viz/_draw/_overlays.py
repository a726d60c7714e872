"""One picture of the cloth with what was seen in it and what is to be done."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine
from polyfold.types import Action, ActionMap, Observation, Scene
from polyfold.viz._draw._canvas import Canvas, Surface
from polyfold.viz._draw._drawing import (
    draw_action,
    draw_action_map,
    draw_fold_line,
    draw_lifted,
    draw_model,
    draw_outline,
)
from polyfold.viz._draw._saving import save
from polyfold.viz._draw._vector import VectorPage, is_vector

Image = NDArray[np.uint8]


def overlay(
    picture: Observation | Image,
    scene: Scene | None = None,
    fold_line: FoldLine | None = None,
    action: Action | None = None,
    *,
    outline: ArrayLike | None = None,
    action_map: ActionMap | None = None,
    zoom: float = 1.0,
    shown: Image | None = None,
    path: str | Path | None = None,
) -> Image:
    """Draw polygon, fold line and picks and places over a picture.

    The polygon is dark with its creases dashed, hidden vertices are hollow. The fold line is green with teeth on the
    side that is lifted, which is tinted. Each arm's arrow runs from the pick (disc) to the place (tip).

    Args:
        picture: what the camera saw, or its colours, uint8, shape (H, W, 3).
        scene: the grounded scene; its polygon is drawn if it has one.
        fold_line: the planned fold line.
        action: the picks and places.
        outline: an outline to compare with, such as the ideal result [px], shape (N, 2); dashed red.
        action_map: places to pick and their values, as a policy's ``action_map`` gives them; see :func:`value_map`.
        zoom: size of the result relative to the picture.
        shown: what is shown in the picture's place, the same view at another size.
        path: file to write: PNG, or PDF or SVG, in which lines and words stay sharp at any size.

    Returns:
        The picture, uint8, shape (zoom H, zoom W, 3); pixels that nothing covers are unchanged at zoom 1.
    """
    rgb = picture.rgb if isinstance(picture, Observation) else picture
    drawn = Overlay(rgb, scene, fold_line, action, outline, action_map, zoom, shown)
    if path is not None:
        save_drawing(drawn, path)
    return drawn.image()


@dataclass(frozen=True, eq=False)
class Overlay:
    """What :func:`overlay` draws, with its arguments, to be drawn on any surface."""

    rgb: Image
    scene: Scene | None = None
    fold_line: FoldLine | None = None
    action: Action | None = None
    outline: ArrayLike | None = None
    action_map: ActionMap | None = None
    zoom: float = 1.0
    shown: Image | None = None

    def on(self, surface: Surface) -> None:
        """Draw what is over the picture."""
        if self.scene is not None and self.scene.model is not None:
            draw_model(surface, self.scene.model)
        if self.outline is not None:
            draw_outline(surface, self.outline)
        if self.fold_line is not None and self.scene is not None:
            draw_lifted(surface, self.fold_line, self.scene)
        if self.action_map is not None:
            draw_action_map(surface, self.action_map)
        if self.fold_line is not None:
            draw_fold_line(surface, self.fold_line, self.scene)
        if self.action is not None:
            draw_action(surface, self.action)

    def image(self) -> Image:
        """All of it as pixels, uint8, shape (zoom H, zoom W, 3)."""
        canvas = Canvas(self.rgb, self.zoom, self.shown)
        self.on(canvas)
        return canvas.image()


def save_drawing(drawn: Overlay, path: str | Path) -> Path:
    """Write a picture with what is drawn over it: PDF and SVG with shapes, else pixels as PNG."""
    if not is_vector(path):
        return save(drawn.image(), path)
    height, width = drawn.rgb.shape[:2]
    page = VectorPage(round(width * drawn.zoom), round(height * drawn.zoom))
    page.drawing(drawn, 0, 0)
    return page.save(path)


def value_map(
    picture: Observation | Image,
    points: ArrayLike,
    values: ArrayLike,
    fold_line: FoldLine | None = None,
    action: Action | None = None,
    *,
    zoom: float = 1.0,
) -> Image:
    """Colour pixels by their value, such as the predicted outcome of picking there: dark blue low, yellow high.

    Args:
        picture: what the camera saw, or its colours.
        points: where the values belong [px], shape (N, 2).
        values: shape (N,); coloured between their smallest and largest, what is not finite is left out.
        fold_line, action: drawn as by :func:`overlay`.
        zoom: size of the result relative to the picture.
    """
    action_map = np.asarray(points, float), np.asarray(values, float)
    return overlay(picture, None, fold_line, action, action_map=action_map, zoom=zoom)
