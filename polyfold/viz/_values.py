"""Single values as pictures: what was seen, what was made of it, what is to be done, and what garments look like."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment
from polyfold.geometry import FoldLine
from polyfold.polygon import FoldedModel, Template
from polyfold.tasks import Task
from polyfold.types import Action, Observation, Scene
from polyfold.viz._draw._canvas import Canvas, Page, fitted
from polyfold.viz._draw._drawing import draw_action, draw_fold_line
from polyfold.viz._draw._overlays import overlay
from polyfold.viz._draw._polygons import TABLE, grounding_picture, polygon_picture
from polyfold.viz._draw._style import FAINT, INK, MAP, RULE
from polyfold.viz._tasks import task_sheet

Image = NDArray[np.uint8]

SIDE = 400
"""Of pictures of what has no picture of its own [px]."""
CAPTION = 15


@singledispatch
def picture_of(value: Any) -> Image:
    """A value as a picture, uint8, shape (H, W, 3). Raises TypeError for what is none."""
    raise TypeError(f"a {type(value).__name__} is no picture")


@picture_of.register
def _observation(seen: Observation) -> Image:
    """Colours, and depth beside them: the nearer, the brighter."""
    height, width = seen.rgb.shape[:2]
    page = Page(2 * width + 12, height + 26)
    near, far = float(np.nanmin(seen.depth)), float(np.nanmax(seen.depth))
    share = (far - seen.depth) / max(far - near, 1e-9)
    stops, places = np.array(MAP, float), np.linspace(0.0, 1.0, len(MAP))
    depth = np.stack([np.interp(np.nan_to_num(share), places, stops[:, k]) for k in range(3)], axis=-1)
    depth[np.isnan(seen.depth)] = 255.0
    for column, picture in enumerate((seen.rgb, depth.astype(np.uint8))):
        page.picture(picture, column * (width + 12), 0)
    page.text(f"colour, {width} × {height} px", 2, height + 5, CAPTION, FAINT)
    page.text(
        f"depth, {1000 * near:.1f} to {1000 * far:.1f} mm from the camera", width + 14, height + 5, CAPTION, FAINT
    )
    return page.image()


@picture_of.register
def _scene(scene: Scene) -> Image:
    """What was seen, or the mask where that is not kept, with the polygon and its names."""
    width, height = scene.image_size
    rgb = scene.picture
    if rgb is None:
        rgb = np.full((height, width, 3), TABLE, np.uint8)
        rgb[scene.mask] = RULE
    if scene.model is None:
        return overlay(rgb, outline=scene.contour)
    residual = f", fitted to {scene.residual:.1f} px" if np.isfinite(scene.residual) else ""
    return grounding_picture(rgb, scene.model, f"{scene.kind}{residual}")


@picture_of.register
def _model(model: FoldedModel) -> Image:
    """Paper cut-outs with the names of the vertices."""
    size = np.ceil(model.outline().max(0)).astype(int) + 40
    width, height = (max(SIDE, int(side)) for side in size)
    return grounding_picture(polygon_picture(model, (width, height)), model, model.kind)


@picture_of.register
def _template(template: Template) -> Image:
    """The first canonical shape with the names of its vertices."""
    return picture_of(template.model(template.canonical * 0.7 * SIDE + SIDE / 2))


@picture_of.register
def _fold_line(line: FoldLine) -> Image:
    """The arrow, with teeth on the side that is lifted, in a picture of the usual size."""
    canvas = Canvas(_table(np.array([line.start, line.end])))
    draw_fold_line(canvas, line)
    return canvas.image()


@picture_of.register
def _action(action: Action) -> Image:
    """Picks and places, one colour an arm, in a picture of the usual size."""
    canvas = Canvas(_table(np.vstack([action.picks, action.places])))
    draw_action(canvas, action)
    return canvas.image()


def _table(points: NDArray[np.float64]) -> Image:
    """A bare table that is large enough for these points [px]."""
    width, height = (max(SIDE, int(side) + 40) for side in points.max(0))
    return np.full((height, width, 3), TABLE, np.uint8)


@picture_of.register
def _task(task: Task) -> Image:
    """The cloth before each fold, with its line, and the end."""
    return task_sheet([task])


@picture_of.register
def _garment(garment: Garment) -> Image:
    """The garment spread flat, upright, with its keypoints by name and its size; before it the photo it comes from."""
    drawn = _spread(garment)
    if garment.photo is None:
        return drawn
    side = drawn.shape[0]
    page = Page(side + 12 + drawn.shape[1], side)
    page.picture(fitted(garment.photo, side), 0, 0)
    page.picture(drawn, side + 12, 0)
    return page.image()


def _spread(garment: Garment) -> Image:
    from polyfold.polygon import FoldedModel

    flat = garment.mesh.vertices
    extent = np.ptp(flat, axis=0)
    scale = 0.8 * SIDE / float(extent.max())
    seen = (flat - flat.min(0) - extent / 2) * (1.0, -1.0) * scale + SIDE / 2
    canvas = Canvas(np.full((SIDE, SIDE, 3), TABLE, np.uint8))
    canvas.fill(seen[garment.mesh.boundary], garment.colours[0])
    names = tuple(garment.keypoints)
    corners = seen[[garment.keypoints[name] for name in names]]
    title = f"{garment.name}: {100 * extent[0]:.0f} × {100 * extent[1]:.0f} cm, {garment.fabric.name}"
    if len(names) < 3:
        page = Page.over(canvas.image())
        page.text(title, 8, 8, CAPTION, INK)
        return page.image()
    # Around the outline, whatever order they were named in.
    ring = {int(vertex): place for place, vertex in enumerate(garment.mesh.boundary)}
    order = np.argsort([ring.get(garment.keypoints[name], 0) for name in names])
    model = FoldedModel(
        corners[order], tuple(names[k] for k in order), dict.fromkeys(names, "keypoint"), kind=garment.kind
    )
    return grounding_picture(canvas.image(), model, title)
