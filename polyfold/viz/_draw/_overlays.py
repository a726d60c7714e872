"""One picture of the cloth with what was seen in it and what is to be done."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine
from polyfold.types import Action, ActionMap, Observation, Scene
from polyfold.viz._draw._canvas import Canvas
from polyfold.viz._draw._drawing import (
    draw_action,
    draw_action_map,
    draw_fold_line,
    draw_lifted,
    draw_model,
    draw_outline,
)

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

    Returns:
        The picture, uint8, shape (zoom H, zoom W, 3); pixels that nothing covers are unchanged at zoom 1.
    """
    canvas = Canvas(picture.rgb if isinstance(picture, Observation) else picture, zoom, shown)
    if scene is not None and scene.model is not None:
        draw_model(canvas, scene.model)
    if outline is not None:
        draw_outline(canvas, outline)
    if fold_line is not None and scene is not None:
        draw_lifted(canvas, fold_line, scene)
    if action_map is not None:
        draw_action_map(canvas, action_map)
    if fold_line is not None:
        draw_fold_line(canvas, fold_line, scene)
    if action is not None:
        draw_action(canvas, action)
    return canvas.image()


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
